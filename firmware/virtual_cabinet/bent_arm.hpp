// SPDX-License-Identifier: MIT
// What real arms do beside their geometry, for an emulated one, in files and behind a controller:
// transmissions and encoders that read a little wrong by waves that repeat with the turn, gravity,
// play.
#pragma once

#include "core/base/arm.hpp"
#include "core/calibration/model.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::cabinet {

struct Bends {
  double map_rad = 0;   // largest error of a reading, of every revolute joint; a slide's in m: so
                        // many times 0.5 m
  double sag_m = 0;     // of the last link's origin, the arm stretched out level
  double play_rad = 0;  // from one end of it to the other; a slide's in m: so many times 0.5 m

  [[nodiscard]] bool any() const { return map_rad > 0 || sag_m > 0 || play_rad > 0; }
};

// Gravity and maps of that size on the drawing: of every joint waves of 1 to 17 a turn, as a spline
// has them, and the lever of the last link's origin.
[[nodiscard]] calibration::ArmModel bent_model(const Arm& drawing, const Bends& bends,
                                               simulated::Random& random);

// Of a reading of that joint for `rad` of a revolute one: itself, or so many times 0.5 m.
[[nodiscard]] double bend_amount(JointType type, double rad);

// Readings that have such an arm without play where it is when its encoders read `readings`, each
// less `behind`, where that is told.
[[nodiscard]] JointVector turned(const calibration::ArmModel& model, const JointVector& readings,
                                 const JointVector& behind = {});

}  // namespace armsig::cabinet
