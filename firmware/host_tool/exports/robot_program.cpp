// SPDX-License-Identifier: MIT
#include "firmware/host_tool/exports/robot_program.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include <fmt/core.h>

#include "core/base/check.hpp"
#include "core/base/error.hpp"
#include "core/base/pose.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/poses.hpp"
#include "firmware/formats/text_file.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kRobotAxes = 6;  // of the robots that these languages move

// "a, b, c" of the readings in `unit` (1: radians, else degrees).
std::string list_of(const JointVector& q, bool in_degrees) {
  std::string text;
  for (std::size_t i = 0; i < q.size(); ++i) {
    text += fmt::format("{}{:.6f}", i == 0 ? "" : ", ", in_degrees ? degrees(q[i]) : q[i]);
  }
  return text;
}

std::string urscript(const Programme& programme, std::span<const JointVector> poses) {
  std::string text = fmt::format("# {}\ndef armsig_poses():\n", programme.comment);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    text += fmt::format("  # pose {}\n  movej([{}], a=0.5, v=0.3)\n  sleep({})\n", k + 1,
                        list_of(poses[k], false), programme.wait_s);
  }
  return text + "end\narmsig_poses()\n";
}

std::string rapid(const Programme& programme, std::span<const JointVector> poses) {
  std::string text = fmt::format("MODULE ArmsigPoses\n  ! {}\n", programme.comment);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    text += fmt::format("  CONST jointtarget pose{} := [[{}], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];\n",
                        k + 1, list_of(poses[k], true));
  }
  text += "  PROC main()\n";
  for (std::size_t k = 0; k < poses.size(); ++k) {
    text += fmt::format("    MoveAbsJ pose{}\\NoEOffs, v100, fine, tool0;\n    WaitTime {};\n",
                        k + 1, programme.wait_s);
  }
  return text + "  ENDPROC\nENDMODULE\n";
}

std::string krl(const Programme& programme, std::span<const JointVector> poses) {
  std::string text = fmt::format(
      "&ACCESS RVP\nDEF armsig_poses()\n  ; {}\n  BAS(#INITMOV, 0)\n  BAS(#VEL_PTP, 10)\n",
      programme.comment);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    std::string axes;
    for (std::size_t i = 0; i < kRobotAxes; ++i) {
      axes += fmt::format("{}A{} {:.6f}", i == 0 ? "" : ", ", i + 1, degrees(poses[k][i]));
    }
    text +=
        fmt::format("  ; pose {}\n  PTP {{{}}}\n  WAIT SEC {}\n", k + 1, axes, programme.wait_s);
  }
  return text + "END\n";
}

struct Language {
  std::string_view format;
  std::string (*text)(const Programme&, std::span<const JointVector>);
};
constexpr std::array kLanguages{Language{"urscript", urscript}, Language{"rapid", rapid},
                                Language{"krl", krl}};

}  // namespace

std::vector<std::string> program_formats() {
  std::vector<std::string> formats{"csv"};
  for (const Language& language : kLanguages) formats.emplace_back(language.format);
  return formats;
}

Read<std::string> program_text(const Programme& programme, const JointTypes& types,
                               std::span<const JointVector> poses) {
  const auto* language = std::ranges::find(kLanguages, programme.format, &Language::format);
  ARMSIG_CHECK(language != kLanguages.end());
  const bool all_turn =
      std::ranges::all_of(types, [](JointType type) { return type == JointType::kRevolute; });
  if (types.size() != kRobotAxes || !all_turn) {
    return std::unexpected(Problem{"--format", 0, 0,
                                   fmt::format("{} moves no such arm", programme.format),
                                   "six revolute joints; csv holds any"});
  }
  Programme safe = programme;
  safe.comment = shown(programme.comment);
  return language->text(safe, poses);
}

Read<void> write_poses(const std::string& path, const Programme& programme, const JointTypes& types,
                       std::span<const JointVector> poses) {
  if (programme.format == "csv") return write_joint_poses(path, types, poses, programme.comment);
  ARMSIG_TRY(text, program_text(programme, types, poses));
  return write_text_file(path, text);
}

}  // namespace armsig::tool
