// SPDX-License-Identifier: MIT
// Which readings a controller goes to for a target: by the words of its configuration, or nearest
// to where the arm was.
#pragma once

#include <optional>

#include "firmware/host_tool/programs/correct_program.hpp"

namespace armsig::tool {

// Of the nominal model, by the directions of the controller's base: x forward, z up. Precondition:
// six revolute joints.
[[nodiscard]] Stance stance_of(const Arm& nominal, const Matrix3& R_0C, const JointVector& q);

// Are both in one configuration, in whatever words: the same side of every place where some maker's
// words change? Those are the wrist over axis 1, the stretched arm, joint 5 at zero, joint 4 at
// quarter turns, and half turns of joints 1, 4 and 6.
[[nodiscard]] bool in_one_configuration(const Arm& nominal, const Matrix3& R_0C,
                                        const JointVector& one, const JointVector& other);

struct Chosen {
  std::optional<JointVector> readings;
  std::string why_not;  // a phrase, where there are none
};

// The readings for the pose X_BF of the flange of the nominal model. `before`: where the arm was;
// empty: not known.
[[nodiscard]] Chosen chosen_readings(const ControllerView& controller, const Language& language,
                                     const ProgramTarget& target, const Pose& X_BF,
                                     const JointVector& before);

}  // namespace armsig::tool
