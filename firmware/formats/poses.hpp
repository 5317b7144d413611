// SPDX-License-Identifier: MIT
// Pose files (CSV): joint poses q1_deg ..., and tool poses x_m, y_m, z_m, qw, qx, qy, qz, or the
// orientation as makers write it, in the sensor frame (docs/formats.md).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

[[nodiscard]] Read<std::vector<JointVector>> read_joint_poses(const std::string& path,
                                                              const JointTypes& types);
[[nodiscard]] Read<std::vector<JointVector>> parse_joint_poses(std::string_view text,
                                                               std::string_view file,
                                                               const JointTypes& types);

// Refuses a quaternion whose length is not 1 within 1e-3, and scales the others to 1. Passes over
// the sigmas that write_tool_poses may add.
[[nodiscard]] Read<std::vector<Pose>> read_tool_poses(const std::string& path);
[[nodiscard]] Read<std::vector<Pose>> parse_tool_poses(std::string_view text,
                                                       std::string_view file);

// Atomically, with 17 digits; degrees and millimetres for joints, metres for tool poses. Numbers
// that are not finite are refused, and then no file is written.
[[nodiscard]] Read<void> write_joint_poses(const std::string& path, const JointTypes& types,
                                           std::span<const JointVector> poses,
                                           std::string_view comment = {});
// `sigmas_m`: none, or one vector per pose: the position's 1 sigma along x, y, z, to which its
// length is added as a column of its own.
[[nodiscard]] Read<void> write_tool_poses(const std::string& path, std::span<const Pose> poses,
                                          std::string_view comment = {},
                                          std::span<const Vector3> sigmas_m = {});

}  // namespace armsig::tool
