// SPDX-License-Identifier: MIT
// Gates for gross outliers, Huber's loss, and a scale from the median that they cannot move (Huber,
// Robust Statistics, 1981).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/numerics/quantiles.hpp"

namespace armsig::numerics {

// Thresholds on the length of a residual in units of sigma, for one scalar and for three, passed by
// one good row in a million.
inline constexpr double kGate1 = 4.9;
inline constexpr double kGate3 = 5.7;

// Exact data would leave a scale of zero, and no row a weight.
inline constexpr double kLeastScale_m = 1e-9;

struct RobustThresholds {
  double gate = kGate3;
  double median = kChiSquareMedian3;
};
inline constexpr RobustThresholds kThresholds1{kGate1, kChiSquareMedian1};
inline constexpr RobustThresholds kThresholds3{kGate3, kChiSquareMedian3};

// The median of many positive numbers in one pass and constant memory: a histogram over their
// binary logarithm with 8 bins an octave, interpolated; within 2 % of the true median of a smooth
// law.
class LogHistogram {
 public:
  void add(double value, std::size_t times = 1) {
    // The upper bits of a positive double are its logarithm, to within the mantissa's curvature.
    const auto bits = std::bit_cast<std::uint64_t>(std::max(value, kLowest)) >> kShift;
    const auto bin = std::min(static_cast<std::size_t>(bits - kFirst), kBins - 1);
    counts_[bin] += static_cast<std::uint32_t>(times);
    total_ += times;
    lowest_ = std::min(lowest_, bin);
  }

  // 0 when nothing was added, or when half of the values are below 2^-90.
  [[nodiscard]] double median() const {
    const double half = 0.5 * static_cast<double>(total_);
    double below = 0;
    for (std::size_t bin = lowest_; bin < kBins; ++bin) {
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
  static constexpr std::size_t kBins = 1024;  // 2^-90 ... 2^38
  static constexpr double kLowest = 0x1p-90;
  static constexpr int kShift = 49;  // 3 of the 52 bits of the mantissa stay
  static constexpr std::uint64_t kFirst = std::bit_cast<std::uint64_t>(kLowest) >> kShift;
  static double edge(std::size_t bin) {
    return std::bit_cast<double>((kFirst + static_cast<std::uint64_t>(bin)) << kShift);
  }

  std::array<std::uint32_t, kBins> counts_{};
  std::size_t total_ = 0;
  std::size_t lowest_ = kBins;
};

// The scale per axis [m] of residuals in space, of which `squares` holds the squared lengths [m^2].
[[nodiscard]] inline double robust_scale_m(const LogHistogram& squares) {
  return std::max(kLeastScale_m, std::sqrt(squares.median() / kChiSquareMedian3));
}

// Huber's weight of a residual length, and the loss that it descends: squares up to twice the
// scale, straight on from there.
[[nodiscard]] inline double huber_weight(double residual, double scale) {
  return residual <= 2 * scale ? 1 : 2 * scale / residual;
}
[[nodiscard]] inline double huber_loss(double residual, double scale) {
  const double knee = 2 * scale;
  return residual <= knee ? residual * residual : knee * (2 * residual - knee);
}

}  // namespace armsig::numerics
