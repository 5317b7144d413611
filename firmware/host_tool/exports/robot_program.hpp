// SPDX-License-Identifier: MIT
// Joint poses as a program that a robot's controller runs: it goes to each and waits there, for the
// sensor to measure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// csv, urscript, rapid, krl.
[[nodiscard]] std::vector<std::string> program_formats();

struct Programme {
  std::string format;
  std::string comment;  // what the poses are; one line
  double wait_s = 2;    // at each pose
};

// The text of the program: URScript (movej, radians), RAPID (MoveAbsJ, degrees; robax of six axes)
// or KRL (PTP of axes, degrees), at a slow pace. Refuses an arm that the language does not move:
// other than six revolute joints. Preconditions: a format of program_formats() that is not csv; one
// reading a joint.
[[nodiscard]] Read<std::string> program_text(const Programme& programme, const JointTypes& types,
                                             std::span<const JointVector> poses);

// Writes them as a program, or as CSV.
[[nodiscard]] Read<void> write_poses(const std::string& path, const Programme& programme,
                                     const JointTypes& types, std::span<const JointVector> poses);

}  // namespace armsig::tool
