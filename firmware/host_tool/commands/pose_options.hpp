// SPDX-License-Identifier: MIT
// What the commands that write poses to measure ask for alike: where the poses may be, and as what
// they are written.
#pragma once

#include <string>
#include <vector>

#include "core/clearance/surroundings.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/exports/robot_program.hpp"
#include "firmware/host_tool/simulation/margin.hpp"

namespace armsig::tool {

struct PoseOptions : CommonOptions {
  std::string out;
  std::string format = "csv";
  std::vector<double> box_mm;  // of the whole arm: lowest x, y, z, then highest; or none
  double margin_deg = 2;
  double margin_mm = 5;
  double wait_s = 2;

  // What the arm stays clear of: as it is mounted, the box, and a target `hand_m` from the last
  // origin.
  [[nodiscard]] clearance::Surroundings around(const Arm& arm, const clearance::Mounting& mounting,
                                               double hand_m) const;
  [[nodiscard]] Margin margin() const;
  // `comment`: what the poses are.
  [[nodiscard]] Programme program(std::string comment, const clearance::Surroundings& around) const;
};

// The common options are among them.
void add_pose_options(CLI::App& command, PoseOptions& options);

}  // namespace armsig::tool
