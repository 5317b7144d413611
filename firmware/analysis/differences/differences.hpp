// SPDX-License-Identifier: MIT
// What is different about one arm, joint by joint: how far each axis is tilted and shifted from
// where the drawing puts it on the link before, the zero and the scale of its reading, each with
// one sigma and its effect at the tool. What Denavit-Hartenberg rows cannot say near parallel axes.
#pragma once

#include "core/calibration/refined.hpp"
#include "firmware/analysis/differences/difference_effects.hpp"

namespace armsig::differences {

struct Difference {
  std::size_t joint = 0;  // from 0
  Cause cause = Cause::kTiltX;
  // rad of a tilt and of a revolute joint's reading, m of a shift and of a prismatic joint's zero,
  // 1 of a scale; of an error once or twice a turn the amplitude; of a map and of gravity the
  // largest over the work volume.
  double value = 0;
  double sigma = 0;  // one sigma; 0 where nothing is known about it
  Effect effect;
};

struct Differences {
  FixedVector<DrawnAxis, kMaxJoints> axes;  // what directions of a difference mean
  // Only what the axis lines and the readings tell: what the choice of the base, of the tool and of
  // the zeros makes nought is left out.
  FixedVector<Difference, kMaxJoints * kCauses> all;
  double total_rms_m = 0;  // of the drawing with base and tool fitted: the sum of all adds_m
};

// Of the arm that `estimate` describes, its tool at target index `tool`. An estimate without
// unknowns is exact. Errors: kNotConverged, kNotFinite where the arm is not the drawing's at all.
// `bendings`: maps and gravity of both; those of `estimate.readings` are not looked at.
// Preconditions: joints of the drawing's types; limits for each; couplings of both the same.
[[nodiscard]] Result<Differences> differences(const Arm& drawing,
                                              const calibration::Refined& estimate,
                                              std::size_t tool, const Bendings& bendings = {});

// The drawing as a model of that arm, with base and tool as they fit its tool best over the work
// volume: what a calibration of base and tool alone would give. Its only target is the tool. Errors
// and preconditions as for differences().
[[nodiscard]] Result<Signature> fitted_drawing(const Arm& drawing,
                                               const calibration::Refined& estimate,
                                               std::size_t tool);

}  // namespace armsig::differences
