// SPDX-License-Identifier: MIT
// Huber's weight with a gate for gross outliers, and a scale from the median that gross outliers
// cannot move (Huber, Robust Statistics, 1981; Hampel's three-part rule in the small).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace armsig::refinement {

// Thresholds on the length of a residual in units of sigma, for one scalar and for three. The knees
// are passed by 0.5 % of good rows, which costs well under one per cent of efficiency; the gates by
// one good row in a million.
inline constexpr double kHuberKnee1 = 2.8;
inline constexpr double kHuberKnee3 = 3.6;
inline constexpr double kGate1 = 4.9;
inline constexpr double kGate3 = 5.7;
// Medians of the chi-square law with one and three degrees of freedom.
inline constexpr double kMedianChiSquare1 = 0.4549364;
inline constexpr double kMedianChiSquare3 = 2.3659739;

struct RobustThresholds {
  double knee = kHuberKnee3;
  double gate = kGate3;
  double median = kMedianChiSquare3;
};
inline constexpr RobustThresholds kThresholds1{kHuberKnee1, kGate1, kMedianChiSquare1};
inline constexpr RobustThresholds kThresholds3{kHuberKnee3, kGate3, kMedianChiSquare3};

// Weight of the square of a residual of length `length` (in sigma); 0 beyond the gate.
[[nodiscard]] inline double robust_weight(double length, const RobustThresholds& t) {
  if (length <= t.knee) return 1;
  return length <= t.gate ? t.knee / length : 0;
}

// What the residual adds to the robust sum of squares: its square, then a line, then a constant.
[[nodiscard]] inline double robust_loss(double length, const RobustThresholds& t) {
  if (length <= t.knee) return length * length;
  return t.knee * (2 * std::min(length, t.gate) - t.knee);
}

// The median of many positive numbers in one pass and constant memory: a histogram over their
// binary logarithm with 16 bins an octave, interpolated; within 1 % of the true median of a smooth
// law.
class LogHistogram {
 public:
  void add(double value, std::size_t times = 1) {
    // The upper bits of a positive double are its logarithm, to within the mantissa's curvature.
    const auto bits = std::bit_cast<std::uint64_t>(std::max(value, kLowest));
    const auto bin =
        static_cast<std::size_t>((bits - std::bit_cast<std::uint64_t>(kLowest)) >> kShift);
    counts_[std::min(bin, counts_.size() - 1)] += static_cast<std::uint32_t>(times);
    total_ += times;
  }
  [[nodiscard]] std::size_t total() const { return total_; }

  // 0 when nothing was added, or when half of the values are below 2^-100.
  [[nodiscard]] double median() const {
    const double half = 0.5 * static_cast<double>(total_);
    double below = 0;
    for (std::size_t bin = 0; bin < counts_.size(); ++bin) {
      const auto count = static_cast<double>(counts_[bin]);
      if (count > 0 && below + count >= half) {
        if (bin == 0) return 0;
        return edge(bin) + (edge(bin + 1) - edge(bin)) * (half - below) / count;
      }
      below += count;
    }
    return 0;
  }

 private:
  static constexpr double kLowest = 0x1p-100;
  static constexpr int kShift = 48;  // 4 of the 52 bits of the mantissa stay
  static double edge(std::size_t bin) {
    return std::bit_cast<double>(std::bit_cast<std::uint64_t>(kLowest) +
                                 (static_cast<std::uint64_t>(bin) << kShift));
  }

  std::array<std::uint32_t, 2048> counts_{};  // 2^-100 ... 2^28
  std::size_t total_ = 0;
};

}  // namespace armsig::refinement
