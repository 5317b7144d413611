// SPDX-License-Identifier: MIT
// Points that wait, judged together: a least-median start over minimal subsets, then gating to a
// fixed point (docs/model.md, section 2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.hpp"
#include "core/features/gate.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// An image of little memory sweeps in fewer points than this, and they never fill it.
#ifdef ARMSIG_LITTLE_MEMORY
inline constexpr std::size_t kGateCapacity = 53;
#else
inline constexpr std::size_t kGateCapacity = 128;
#endif

// Points that wait to be judged together.
using WaitingPoints = FixedVector<SweepPoint, kGateCapacity>;
using Verdicts = std::array<bool, kGateCapacity>;  // true: accepted

// Judges the waiting points together, on top of those accepted before, of which there may be none;
// a bounded step at a time: one subset tried, or one point judged. What it is given must outlive
// it, unchanged.
class Judging {
 public:
  Judging(const MotionStatistics& accepted, bool sigma_is_known, const WaitingPoints& waiting);

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] const Verdicts& result() const { return verdicts_; }

 private:
  using Coefficients = MotionRls::Coefficients;
  // The waiting points by ascending reading, so that the order of the rows cannot matter.
  using Order = FixedVector<std::uint8_t, kGateCapacity>;
  enum class Stage : std::uint8_t { kMedians, kCosts, kRounds, kOver };

  // Small deterministic generator (linear congruential, Knuth's MMIX constants): the same sweep
  // always gets the same subsets.
  class Sequence {
   public:
    std::size_t below(std::size_t bound) {
      state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
      return static_cast<std::size_t>((state_ >> 33U) % bound);
    }

   private:
    std::uint64_t state_ = 1;
  };

  [[nodiscard]] MotionStatistics base() const;
  [[nodiscard]] MotionRls candidate();
  // Of all rows from a fit: quick, for ranking. Infinite where not a number.
  using Distances = std::array<double, kGateCapacity>;
  void squared_distances(const Coefficients& fit, Distances& distances) const;
  void try_median();
  void try_cost();
  void begin_round();
  void judge(std::size_t place);
  void end_round();

  const MotionStatistics& accepted_;
  const WaitingPoints& waiting_;
  // Their regressors and positions in the order, weighted to unit variance per axis, column by
  // column; the first is the weight.
  std::array<std::array<double, kGateCapacity>, 6> columns_{};
  MotionRls motion_;       // that points are judged by
  MotionStatistics next_;  // base(), and at the end of a round the points that have passed in it
  Coefficients fit_;
  GateScale scale_;
  std::size_t count_ = 0;  // of the stage: subsets tried, or points judged in this round
  Sequence sequence_;
  double least_median_;
  double least_cost_;
  int round_ = 0;
  Order order_;
  Verdicts verdicts_{};
  bool sigma_is_known_;
  bool changed_ = false;
  Stage stage_ = Stage::kMedians;
};

}  // namespace armsig::features
