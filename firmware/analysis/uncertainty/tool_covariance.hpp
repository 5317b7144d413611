// SPDX-License-Identifier: MIT
// How well the tool position is known: the covariance of the unknowns, propagated to any
// configuration (docs/model.md, section 6).
#pragma once

#include "core/calibration/refined.hpp"

namespace armsig::uncertainty {

// Covariance [m^2] of the position of target `target` in the sensor frame at joint readings
// `readings`, with what the refinement left unexplained. Precondition: the information of `refined`
// is regular, as calibration::geometry_to_signature() leaves it.
[[nodiscard]] Matrix3 tool_covariance(const calibration::Refined& refined,
                                      const JointVector& readings, std::size_t target);

// Position of target `target` in the sensor frame at joint readings `readings`.
[[nodiscard]] Vector3 tool_position(const calibration::Refined& refined,
                                    const JointVector& readings, std::size_t target);

// Predicted RMS error [m] of the position of target `target` over `count` configurations of the
// work volume.
[[nodiscard]] double predicted_rms(const calibration::Refined& refined,
                                   const FixedVector<JointLimits, kMaxJoints>& limits,
                                   std::size_t target, int count = 200);

}  // namespace armsig::uncertainty
