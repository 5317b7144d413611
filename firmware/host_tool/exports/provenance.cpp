// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/provenance.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/units.hpp"

namespace armsig::tool {

std::string provenance(const SignatureRecord& record) {
  std::string serial = record.serial.empty() ? "" : ", serial number " + shown(record.serial);
  return fmt::format(
      "Arm signature of {}{}; method {}, {}, {}.\n"
      "Lengths in metres and angles in radians unless a name says otherwise.\n",
      shown(record.arm_name), serial, shown(record.method), shown(record.time),
      shown(record.version));
}

std::string pose_words(const Pose& X) {
  const Eigen::Quaterniond q(X.R);
  return fmt::format("x_m={},y_m={},z_m={},qw={},qx={},qy={},qz={}", number_text(X.p.x()),
                     number_text(X.p.y()), number_text(X.p.z()), number_text(q.w()),
                     number_text(q.x()), number_text(q.y()), number_text(q.z()));
}

std::string xml_comment(std::string text) {
  for (std::size_t at = 0; (at = text.find("--", at)) != std::string::npos;)
    text[at] = '-', text[at + 1] = ' ';
  return "<!--\n" + text + "-->";
}

std::string coupling_lines(const Arm& arm) {
  std::string text;
  for (const JointCoupling& coupling : arm.couplings) {
    text += fmt::format("effective reading of joint {} = reading {} + {} * reading {}\n",
                        coupling.joint + 1, coupling.joint + 1, number_text(coupling.ratio),
                        coupling.from + 1);
  }
  return text;
}

std::unexpected<Problem> cannot_hold(std::string_view format, std::string what,
                                     std::string expected) {
  return std::unexpected(Problem{"", 0, 0, fmt::format("{} can't hold this arm: {}", format, what),
                                 std::move(expected)});
}

Read<void> need_six_revolute(std::string_view format, const Signature& signature) {
  for (std::size_t i = 0; i < signature.joint_count(); ++i) {
    if (signature.types[i] == JointType::kRevolute) continue;
    return cannot_hold(format, fmt::format("joint {} is {}", i + 1, word_of(signature.types[i])),
                       "six revolute joints; urdf holds any arm");
  }
  if (signature.joint_count() != 6) {
    return cannot_hold(format, fmt::format("it has {} joints", signature.joint_count()),
                       "six revolute joints; urdf holds any arm");
  }
  return {};
}

}  // namespace armsig::tool
