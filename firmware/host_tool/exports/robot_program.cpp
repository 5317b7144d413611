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

constexpr std::string_view kClearTheArea =
    "Clear the area of the arm, stay outside, keep the emergency stop at hand. Then go on.";

// What the program does, and what it rests on, as comments that begin with `mark`.
std::string preamble(const Programme& programme, std::string_view mark, std::string_view speed) {
  std::string text;
  const auto add = [&](std::string_view line) { text += fmt::format("{}{}\n", mark, line); };
  add(programme.comment);
  add("Written by armsig. It moves the arm by itself, from pose to pose, straight in the joints.");
  for (const std::string& line : programme.assumed) add("Assumed: " + line + ".");
  add("Where it begins, the way to the first pose is not known: move the arm near it by hand.");
  add(fmt::format("Speed: {}. At each pose that is measured it waits {} s.", speed,
                  programme.wait_s));
  add("It stops first, until the operator continues it.");
  add(kClearTheArea);
  return text;
}

std::string remark(std::size_t number, const Stop& stop) {
  return stop.measured ? fmt::format("pose {}", number) : "only gone through";
}

std::string urscript(const Programme& programme, std::span<const Stop> route) {
  std::string text = preamble(programme, "# ", "0.3 rad/s, 0.5 rad/s^2") + "def armsig_poses():\n";
  text += fmt::format("  popup(\"{}\", title=\"armsig\", warning=True, blocking=True)\n",
                      kClearTheArea);
  std::size_t number = 0;
  for (const Stop& stop : route) {
    if (stop.measured) ++number;
    text += fmt::format("  # {}\n  movej([{}], a=0.5, v=0.3)\n", remark(number, stop),
                        list_of(stop.readings, false));
    if (stop.measured) text += fmt::format("  sleep({})\n", programme.wait_s);
  }
  return text + "end\narmsig_poses()\n";
}

std::string rapid(const Programme& programme, std::span<const Stop> route) {
  std::string text = "MODULE ArmsigPoses\n" + preamble(programme, "  ! ", "v100");
  for (std::size_t k = 0; k < route.size(); ++k) {
    text += fmt::format("  CONST jointtarget stop{} := [[{}], [9E9, 9E9, 9E9, 9E9, 9E9, 9E9]];\n",
                        k + 1, list_of(route[k].readings, true));
  }
  text += fmt::format("  PROC main()\n    TPWrite \"{}\";\n    TPWrite \"{}\";\n    Stop;\n",
                      "armsig: clear the area of the arm, stay outside,",
                      "keep the emergency stop at hand, then go on.");
  std::size_t number = 0;
  for (std::size_t k = 0; k < route.size(); ++k) {
    if (route[k].measured) ++number;
    text += fmt::format("    ! {}\n    MoveAbsJ stop{}\\NoEOffs, v100, fine, tool0;\n",
                        remark(number, route[k]), k + 1);
    if (route[k].measured) text += fmt::format("    WaitTime {};\n", programme.wait_s);
  }
  return text + "  ENDPROC\nENDMODULE\n";
}

std::string krl(const Programme& programme, std::span<const Stop> route) {
  std::string text = "&ACCESS RVP\nDEF armsig_poses()\n" +
                     preamble(programme, "  ; ", "10 % of the axes'") +
                     "  HALT\n  BAS(#INITMOV, 0)\n  BAS(#VEL_PTP, 10)\n";
  std::size_t number = 0;
  for (const Stop& stop : route) {
    if (stop.measured) ++number;
    std::string axes;
    for (std::size_t i = 0; i < kRobotAxes; ++i) {
      axes += fmt::format("{}A{} {:.6f}", i == 0 ? "" : ", ", i + 1, degrees(stop.readings[i]));
    }
    text += fmt::format("  ; {}\n  PTP {{{}}}\n", remark(number, stop), axes);
    if (stop.measured) text += fmt::format("  WAIT SEC {}\n", programme.wait_s);
  }
  return text + "END\n";
}

struct Language {
  std::string_view format;
  std::string (*text)(const Programme&, std::span<const Stop>);
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
                               std::span<const Stop> route) {
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
  return language->text(safe, route);
}

Read<void> write_route(const std::string& path, const Programme& programme, const JointTypes& types,
                       std::span<const Stop> route) {
  if (programme.format != "csv") {
    ARMSIG_TRY(text, program_text(programme, types, route));
    return write_text_file(path, text);
  }
  std::vector<JointVector> poses;
  std::size_t through = 0;
  for (const Stop& stop : route) {
    if (!stop.measured && poses.empty()) continue;
    if (!stop.measured) ++through;
    poses.push_back(stop.readings);
  }
  std::string comment = programme.comment;
  if (through > 0) {
    comment +=
        fmt::format("; in this order, as {} of the rows are there to be gone through", through);
  }
  return write_joint_poses(path, types, poses, comment);
}

}  // namespace armsig::tool
