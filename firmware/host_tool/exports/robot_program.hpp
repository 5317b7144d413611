// SPDX-License-Identifier: MIT
// Joint poses as a program that a robot's controller runs: it stops until a person lets it go on,
// then goes to each pose and waits there, for the sensor to measure.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/simulation/route.hpp"

namespace armsig::tool {

// csv, urscript, rapid, krl.
[[nodiscard]] std::vector<std::string> program_formats();

struct Programme {
  std::string format;
  std::string comment;               // what the poses are; one line
  std::vector<std::string> assumed;  // what the ways between them rest on; a line each
  double wait_s = 2;                 // at each pose that is measured
};

// The text of the program: URScript (movej, radians), RAPID (MoveAbsJ, degrees; robax of six axes)
// or KRL (PTP of axes, degrees), at a slow pace. It begins with what it does, what it assumes and
// how fast it is, and stops before it moves (popup, Stop, HALT). Refuses an arm that the language
// does not move: other than six revolute joints. Preconditions: a format of program_formats() that
// is not csv; one reading a joint.
[[nodiscard]] Read<std::string> program_text(const Programme& programme, const JointTypes& types,
                                             std::span<const Stop> route);

// Writes them as a program, or as CSV: there without what the route begins with, unless it is
// measured, and with what it goes by in between.
[[nodiscard]] Read<void> write_route(const std::string& path, const Programme& programme,
                                     const JointTypes& types, std::span<const Stop> route);

}  // namespace armsig::tool
