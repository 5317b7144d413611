// SPDX-License-Identifier: MIT
// How well the tool position is known: the covariance of the unknowns, propagated to any
// configuration (section 6 of ALGORITHMS).
#pragma once

#include <span>

#include "core/refinement/refinement.hpp"

namespace armsig::uncertainty {

// Covariance [m^2] of the position of target `target` in the sensor frame at joint readings
// `readings`. Precondition: the information of `refined` is regular, as refine() leaves it.
[[nodiscard]] Matrix3 tool_covariance(const refinement::Refined& refined,
                                      const JointVector& readings, std::size_t target);

// Position of target `target` in the sensor frame at joint readings `readings`.
[[nodiscard]] Vector3 tool_position(const refinement::Refined& refined, const JointVector& readings,
                                    std::size_t target);

// Configurations spread evenly over the joint limits: the Halton sequence, which leaves no gaps and
// is the same on every machine. `index` counts from 0.
[[nodiscard]] JointVector spread_configuration(std::span<const JointLimits> limits,
                                               std::size_t index);

// Predicted RMS error [m] of the position of target `target` over the first `count` spread
// configurations.
[[nodiscard]] double predicted_rms(const refinement::Refined& refined,
                                   std::span<const JointLimits> limits, std::size_t target,
                                   std::size_t count = 200);

}  // namespace armsig::uncertainty
