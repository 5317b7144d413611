// SPDX-License-Identifier: MIT
// Forward and inverse kinematics of an arm whose joints turn otherwise than their readings say.
#pragma once

#include "core/calibration/servo_readings.hpp"
#include "core/kinematics/inverse.hpp"

namespace armsig::calibration {

// Frame n of `chain` at readings q of an arm whose joints turn as `joints` says. Errors:
// kNotFinite.
[[nodiscard]] Result<Pose> forward(const kinematics::Chain& chain, const ServoReadings& joints,
                                   const JointVector& q);

// The readings, near the readings `seed`, at which forward() is X_0n, as kinematics::inverse()
// finds them. `chain` has joints.turned_limits(), or none; the limits of the readings and
// options.max_step are kept by the readings of a pose that is reached (kConverged, kDegraded);
// those of another verdict may be off them by twice joints.largest(). `lately`: of the inverse
// before, where this one follows it. Errors: those of kinematics::inverse() and
// ServoReadings::readings().
[[nodiscard]] Result<kinematics::InverseSolution> inverse(const kinematics::Chain& chain,
                                                          const ServoReadings& joints,
                                                          const Pose& X_0n, const JointVector& seed,
                                                          const kinematics::InverseOptions& options,
                                                          LatelyTurned& lately);
[[nodiscard]] Result<kinematics::InverseSolution> inverse(
    const kinematics::Chain& chain, const ServoReadings& joints, const Pose& X_0n,
    const JointVector& seed, const kinematics::InverseOptions& options = {});

}  // namespace armsig::calibration
