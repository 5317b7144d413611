// SPDX-License-Identifier: MIT
// The gate: which points of a sweep belong to the joint's motion (ALGORITHMS section 2, Gating).
//
// A point is judged by the chi-square of its innovation: measured minus predicted by the motion fit
// of the points accepted so far, over its own variance and the prediction's. Where the accepted
// points do not predict it yet (the start, or after a jump of the reading), points wait and are
// judged together: a least-median start over minimal subsets, then gating to a fixed point, so that
// neither outliers nor the order of the rows decide. Half of the points may be wrong.
//
// That search costs as much as hundreds of points. Where the noise is stated and the first points
// agree with it, those that wait are taken in as they come, each judged by those before it, and all
// examined again, by all, when somebody asks: as long as every one passes, they are such a fixed
// point already and nothing has to be searched.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.hpp"
#include "core/features/sweep_statistics.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::features {

inline constexpr std::size_t kGateCapacity = 128;

// Points that wait to be judged together.
using WaitingPoints = FixedVector<SweepPoint, kGateCapacity>;
using Verdicts = std::array<bool, kGateCapacity>;  // true: accepted

// Of 3 degrees of freedom: of 10,000 good points the gate rejects one, which biases the covariance
// by 0.1 %.
inline constexpr double kGateChiSquare = numerics::kChiSquare9999[2];

// The scale and the limit of the gate, from the points accepted so far.
struct GateScale {
  double variance = 0;  // by which the points' covariances are multiplied; at least 1 where stated
  double limit = 0;     // of the innovation's chi-square
};
[[nodiscard]] GateScale gate_scale(const MotionStatistics& accepted, bool sigma_is_known);

// A point beside those accepted before it, as if it were one of them.
struct Trial {
  Vector3 regressors;
  MotionRls with_point;
  MotionRls::Innovation innovation;
  // Whether they predict it well enough to judge it alone, and for good.
  [[nodiscard]] bool is_close() const;
};
// Precondition: `accepted` has an origin.
[[nodiscard]] Trial try_point(const MotionStatistics& accepted, const SweepPoint& point);

// Judges `point` alone. Precondition: `trial` is of it by `accepted`, with a finite leverage.
[[nodiscard]] bool passes_gate(const MotionStatistics& accepted, bool sigma_is_known,
                               const SweepPoint& point, const Trial& trial);

// Whether as many points as these, all accepted unseen, agree with each other and with their stated
// covariances (chi-square of all residuals, 99.99 %).
[[nodiscard]] bool is_consistent(const MotionStatistics& accepted);

// The verdict on points that are accepted, by all that are.
class Review {
 public:
  // Of points whose sigma is stated. `accepted` must outlive it, unchanged.
  explicit Review(const MotionStatistics& accepted)
      : accepted_(accepted), fit_(accepted.motion.solve()) {}
  [[nodiscard]] bool confirms(const SweepPoint& point) const;

 private:
  const MotionStatistics& accepted_;
  MotionRls::Coefficients fit_;
};

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
  // Their regressors and positions in that order, weighted to unit variance per axis, column by
  // column; the first is the weight. Rows of zeros fill the last pack.
  struct Rows {
    alignas(32) std::array<std::array<double, kGateCapacity>, 6> columns{};
    std::size_t count = 0;
  };
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
  Rows rows_;
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
