// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/pose_options.hpp"

#include <utility>

#include <fmt/core.h>

#include "firmware/formats/mounting.hpp"

namespace armsig::tool {

Margin PoseOptions::margin() const {
  return {.angle_rad = radians(margin_deg), .length_m = 1e-3 * margin_mm};
}

clearance::Surroundings PoseOptions::around(const Arm& arm, const clearance::Mounting& mounting,
                                            double hand_m) const {
  clearance::Surroundings around = clearance::surroundings_of(arm, mounting);
  around.hand_m = hand_m;
  if (!box_mm.empty()) {
    around.lower_B = 1e-3 * Vector3(box_mm[0], box_mm[1], box_mm[2]);
    around.upper_B = 1e-3 * Vector3(box_mm[3], box_mm[4], box_mm[5]);
  }
  return around;
}

Programme PoseOptions::program(std::string comment, const clearance::Surroundings& around) const {
  return {.format = format,
          .comment = std::move(comment),
          .assumed = {fmt::format("the joint limits of the arm description, less {}° and {} mm",
                                  margin_deg, margin_mm),
                      surroundings_in_words(around), "nothing else stands in the way"},
          .wait_s = wait_s};
}

void add_pose_options(CLI::App& command, PoseOptions& options) {
  command
      .add_option("--box-mm", options.box_mm,
                  "where the whole arm may be, in its base frame: x,y,z lowest, then highest")
      ->delimiter(',')
      ->expected(6);
  command.add_option("--margin-deg", options.margin_deg, "kept from the limits of revolute joints")
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  command.add_option("--margin-mm", options.margin_mm, "kept from those of prismatic ones")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  command
      .add_option("--format", options.format,
                  "of the poses: a table, or a program that goes to each and waits there")
      ->transform(CLI::IsMember(program_formats(), CLI::ignore_case))
      ->capture_default_str();
  command.add_option("--wait-s", options.wait_s, "at each pose, in a program")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command.add_option("-o,--out", options.out, "joint poses to write")->required();
  add_common(command, options);
}

}  // namespace armsig::tool
