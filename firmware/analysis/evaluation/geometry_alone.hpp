// SPDX-License-Identifier: MIT
// The best geometry for those who cannot say gravity and joint error maps, or not all of them.
//
// Geometry that was fitted together with maps does not hold what the maps hold: their means and
// first waves, which without them are zeros of joints and places of axes. It is fitted anew, to
// what the whole model says.
#pragma once

#include <span>

#include "core/base/error.hpp"
#include "core/calibration/model.hpp"
#include "core/calibration/readings.hpp"
#include "core/signature.hpp"

namespace armsig::calibration {

// The readings that the rows of `model` covered; `limits` of a joint where that is not known, and
// of one that stood still, as nobody means an arm that never moves it.
[[nodiscard]] FixedVector<JointLimits, kMaxJoints> covered_limits(
    const ArmModel& model, const FixedVector<JointLimits, kMaxJoints>& limits);

// Configuration n >= 1 (encoder readings) of those spread evenly over covered_limits().
[[nodiscard]] JointVector covered_configuration(const ArmModel& model,
                                                const FixedVector<JointLimits, kMaxJoints>& limits,
                                                int n);

// What is left at some poses, over all targets (of a signature without one on its last link, over
// the origin of that too).
struct Leftover {
  double rms_m = 0;
  double largest_m = 0;
};

// How far `signature`, its joints read by `said`, is from `exact`, read by `whole`.
// Preconditions: one set of targets; at least one pose.
[[nodiscard]] Leftover difference(const Signature& exact, const ReadingModel& whole,
                                  const Signature& signature, const ReadingModel& said,
                                  std::span<const JointVector> poses);

// Moves the axes and targets of `signature`, which is exact where its joints are read by `whole`,
// so that with `said` instead its targets come nearest to where they are, in the mean square over
// `poses` (encoder readings). Gauss and Newton's method; what the poses do not determine stays. The
// last link's frame follows in the mean. The S-Model and pseudo Denavit-Hartenberg parameters are
// not derived anew.
// Errors: kTooFewPoints (poses, 1); kCapacityExceeded (unknowns, capacity); kSingular;
// kNotConverged (largest correction of the last step, the one allowed); `signature` is then as it
// was.
[[nodiscard]] Judged<void> fit_geometry_alone(const ReadingModel& whole, const ReadingModel& said,
                                              std::span<const JointVector> poses,
                                              Signature& signature);

}  // namespace armsig::calibration
