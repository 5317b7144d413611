// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/pose_options.hpp"

#include <utility>

namespace armsig::tool {

Margin PoseOptions::margin() const {
  return {.angle_rad = radians(margin_deg), .length_m = 1e-3 * margin_mm};
}

Programme PoseOptions::program(std::string comment) const {
  return {.format = format, .comment = std::move(comment), .wait_s = wait_s};
}

std::optional<PoseBox> PoseOptions::box() const {
  if (box_mm.empty()) return std::nullopt;
  return PoseBox{1e-3 * Vector3(box_mm[0], box_mm[1], box_mm[2]),
                 1e-3 * Vector3(box_mm[3], box_mm[4], box_mm[5])};
}

void add_pose_options(CLI::App& command, PoseOptions& options, const std::string& box) {
  command.add_option("--box-mm", options.box_mm, box)->delimiter(',')->expected(6);
  command.add_option("--margin-deg", options.margin_deg, "kept from the limits of revolute joints")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  command.add_option("--margin-mm", options.margin_mm, "kept from those of prismatic ones")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command
      .add_option("--format", options.format,
                  "of the poses: a table, or a program that goes to each and waits there")
      ->check(CLI::IsMember(program_formats()))
      ->capture_default_str();
  command.add_option("--wait-s", options.wait_s, "at each pose, in a program")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command.add_option("--out", options.out, "joint poses to write")->required();
  add_common(command, options);
}

}  // namespace armsig::tool
