// SPDX-License-Identifier: MIT
// What the commands that write poses to measure ask for alike: where the poses may be, and as what
// they are written.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/exports/robot_program.hpp"
#include "firmware/host_tool/simulation/margin.hpp"

namespace armsig::tool {

// Metres; in the frame that the command says.
struct PoseBox {
  Vector3 lower;
  Vector3 upper;
};

struct PoseOptions : CommonOptions {
  std::string out;
  std::string format = "csv";
  std::vector<double> box_mm;  // lowest x, y, z, then highest; or none
  double margin_deg = 2;
  double margin_mm = 5;
  double wait_s = 2;

  [[nodiscard]] std::optional<PoseBox> box() const;
  [[nodiscard]] Margin margin() const;
  [[nodiscard]] Programme program(std::string comment) const;
};

// `box`: what the box is of, for --help. The common options are among them.
void add_pose_options(CLI::App& command, PoseOptions& options, const std::string& box);

}  // namespace armsig::tool
