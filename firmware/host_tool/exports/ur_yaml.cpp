// SPDX-License-Identifier: MIT
#include <array>
#include <span>

#include <fmt/core.h>

#include "core/base/crc32.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/joint_frames.hpp"
#include "firmware/host_tool/exports/provenance.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kUrFormat = "ur-yaml";
constexpr std::array kLinks{"shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"};

std::string link_text(const char* name, const Pose& X) {
  const RollPitchYaw angles = roll_pitch_yaw(X.R);
  return fmt::format(
      "  {}:\n    x: {}\n    y: {}\n    z: {}\n    roll: {}\n    pitch: {}\n    yaw: {}\n", name,
      number_text(X.p.x()), number_text(X.p.y()), number_text(X.p.z()),
      number_text(angles.roll_rad), number_text(angles.pitch_rad), number_text(angles.yaw_rad));
}

}  // namespace

Read<std::string> ur_yaml_text(const SignatureRecord& record) {
  if (auto six = need_six_revolute(kUrFormat, record.signature); !six) {
    return std::unexpected(std::move(six).error());
  }
  if (!record.nominal.couplings.empty()) {
    return cannot_hold(kUrFormat, "its joints are coupled", "uncoupled joints; urdf holds any");
  }
  const JointFrames frames = joint_frames(record);
  std::string links;
  for (std::size_t i = 0; i < kLinks.size(); ++i) links += link_text(kLinks[i], frames.X_PJ[i]);
  // The drivers compare the hash with the controller's to warn of a model of another robot.
  const std::uint32_t crc = crc32(std::as_bytes(std::span(links)));
  return comment_text(
             provenance(record) +
             "Kinematics as the Universal Robots drivers read them: every link in the link before "
             "it\nat reading zero, the first in the base.\n"
             "The hash is of these numbers. A driver that compares it with the robot's own "
             "factory\n"
             "calibration reports that they differ, and they do.\n"
             "base in the sensor frame: " +
             pose_words(frames.X_SB) +
             "\nlast link of armsig predict in wrist_3: " + pose_words(frames.X_KL) + "\n") +
         "kinematics:\n" + links + fmt::format("  hash: calib_armsig_{:08x}\n", crc);
}

}  // namespace armsig::tool
