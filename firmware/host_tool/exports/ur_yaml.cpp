// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "core/base/crc32.hpp"
#include "core/frames/alignment.hpp"
#include "core/frames/axis_lines.hpp"
#include "core/identification.hpp"
#include "firmware/formats/csv_text.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/exports/export.hpp"
#include "firmware/host_tool/exports/provenance.hpp"
#include "firmware/host_tool/known_arms/known_arms.hpp"
#include "firmware/library/joint_frames.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"

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

// An individual is nowhere near as far from its drawing.
constexpr double kOtherArm_m = 0.03;
constexpr double kOtherArm_rad = 0.05;

// The drivers take the file for a robot of Universal Robots, whose zeros and senses it must have:
// the arm's axes have to be those of one that is known.
Read<void> need_ur(const SignatureRecord& record) {
  std::vector<std::string> names;
  std::string nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (const KnownArm& known : known_arms()) {
    if (!known.name.starts_with("ur")) continue;
    ARMSIG_TRY(drawn, parse_arm(known.text, known.name));
    const Signature there = signature_of(drawn.arm, record.signature.configuration, Pose{}, {});
    const frames::Alignment laid =
        frames::align(frames::axis_lines(record.signature), frames::axis_lines(there));
    const double off_m = std::sqrt(laid.cost_m2);
    if (laid.worst_distance_m() < kOtherArm_m && laid.worst_angle_rad() < kOtherArm_rad) return {};
    names.emplace_back(known.name);
    if (off_m >= least_m) continue;
    least_m = off_m;
    nearest = known.name;
  }
  return cannot_hold(
      kUrFormat,
      fmt::format("its axes are those of no arm of Universal Robots; nearest is the {}, {:.0f} mm "
                  "off",
                  nearest, 1e3 * least_m),
      fmt::format("{}, with the zeros and senses that the maker has; urdf holds any",
                  any_of(names)));
}

}  // namespace

Read<std::string> ur_yaml_text(const SignatureRecord& record) {
  if (auto six = need_six_revolute(kUrFormat, record.signature); !six) {
    return std::unexpected(std::move(six).error());
  }
  if (!record.nominal.couplings.empty()) {
    return cannot_hold(kUrFormat, "its joints are coupled", "uncoupled joints; urdf holds any");
  }
  if (auto ur = need_ur(record); !ur) return std::unexpected(std::move(ur).error());
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
