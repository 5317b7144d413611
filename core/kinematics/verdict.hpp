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

// Whether the errors of `solution`, those of the chain at its q, are within the tolerances. No
// verdict says that a pose is met where this is false.
[[nodiscard]] inline bool is_position_met(const InverseSolution& solution,
                                          const InverseOptions& options) {
  return solution.position_error_m <= options.position_tolerance_m;
}
[[nodiscard]] inline bool is_met(const InverseSolution& solution, const InverseOptions& options) {
  return is_position_met(solution, options) &&
         solution.rotation_error_rad <= options.rotation_tolerance_rad;
}

}  // namespace armsig::kinematics
