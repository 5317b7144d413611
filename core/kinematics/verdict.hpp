// SPDX-License-Identifier: MIT
// What may be asked of the inverse, and when it is answered: the same for every solver.
#pragma once

#include <optional>

#include "core/kinematics/inverse.hpp"

namespace armsig::kinematics {

// How far R may be from a rotation: as far as an answer may be from its pose.
inline constexpr double kRotationDefect = 1e-9;
// Largest reading (rad or m), position and offset (m): beyond, a pose has no nanometres left.
inline constexpr double kFarthest = 1e6;

// Why the inverse refuses a request, if it does: see inverse() for the errors.
[[nodiscard]] std::optional<Error> refusal(const Pose& X_0n, const JointVector& seed,
                                           const InverseOptions& options);

}  // namespace armsig::kinematics
