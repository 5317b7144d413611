// SPDX-License-Identifier: MIT
#include "firmware/formats/frames_file.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/text_file.hpp"
#include "firmware/formats/yaml_map.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kMostFrames = 500;
constexpr double kUnitLength = 1e-6;

Read<NamedPose> frame_from(const YamlNode& node, const std::string& what) {
  ARMSIG_TRY(map, YamlMap::open(node, what, {"name", "position_m", "quaternion_wxyz"}));
  NamedPose frame;
  ARMSIG_TRY(name, map.name_under("name"));
  ARMSIG_TRY(p, map.vector3("position_m"));
  ARMSIG_TRY(quaternion, map.require("quaternion_wxyz"));
  ARMSIG_TRY(w, read_numbers(*quaternion, "quaternion_wxyz", 4));
  const Eigen::Quaterniond q(w[0], w[1], w[2], w[3]);
  if (!(std::abs(q.coeffs().stableNorm() - 1) <= kUnitLength)) {
    return problem_at(*quaternion,
                      fmt::format("a quaternion of length {}", q.coeffs().stableNorm()),
                      "a unit quaternion w, x, y, z");
  }
  frame.name = name;
  frame.X = {q.normalized().toRotationMatrix(), p};
  return frame;
}

// `what` of the items of the list: "tool". No list has no items.
Read<std::vector<NamedPose>> list_from(const YamlMap& map, const char* key, const char* what) {
  std::vector<NamedPose> all;
  const YamlNode* const node = map.find(key);
  if (node == nullptr) return all;
  ARMSIG_TRY(list, read_list(*node, key, 0, kMostFrames));
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(frame, frame_from(item, fmt::format("{} {}", what, all.size() + 1)));
    if (std::ranges::find(all, frame.name, &NamedPose::name) != all.end()) {
      return problem_at(item, fmt::format("{} {} is there twice", what, in_quotes(frame.name)),
                        "another name for each");
    }
    all.push_back(std::move(frame));
  }
  return all;
}

Read<FramesFile> frames_from(const YamlNode& root) {
  if (auto tag = check_tag(root, kFramesTag); !tag) return std::unexpected(std::move(tag).error());
  ARMSIG_TRY(map, YamlMap::open(root, "the frames", {"armsig", "tools", "work_objects"}));
  ARMSIG_TRY(tools, list_from(map, "tools", "tool"));
  ARMSIG_TRY(work_objects, list_from(map, "work_objects", "work object"));
  if (tools.empty() && work_objects.empty()) {
    return problem_at(root, "no frame is in it", "a tool or a work object");
  }
  return FramesFile{std::move(tools), std::move(work_objects)};
}

std::string list_text(const char* key, const std::vector<NamedPose>& frames) {
  if (frames.empty()) return {};
  std::string text = fmt::format("{}:\n", key);
  for (const NamedPose& frame : frames) {
    const Eigen::Quaterniond q(frame.X.R);
    const Vector3& p = frame.X.p;
    text += fmt::format("  - name: {}\n    position_m: [{}, {}, {}]\n", yaml_quoted(frame.name),
                        number_text(p.x()), number_text(p.y()), number_text(p.z()));
    text += fmt::format("    quaternion_wxyz: [{}, {}, {}, {}]\n", number_text(q.w()),
                        number_text(q.x()), number_text(q.y()), number_text(q.z()));
    for (const std::string& form : frame.forms) text += fmt::format("    # {}\n", form);
  }
  return text;
}

}  // namespace

Read<FramesFile> parse_frames(std::string_view text, std::string_view file) {
  const auto parse = [&]() -> Read<FramesFile> {
    ARMSIG_TRY(root, parse_yaml(text));
    return frames_from(root);
  };
  return in_file(file, parse());
}

Read<FramesFile> read_frames_file(const std::string& path) {
  ARMSIG_TRY(text, read_text_file(path));
  return parse_frames(text, path);
}

std::string frames_text(const FramesFile& frames) {
  return fmt::format("armsig: {}\n", kFramesTag) + list_text("tools", frames.tools) +
         list_text("work_objects", frames.work_objects);
}

Read<void> write_frames_file(const std::string& path, const FramesFile& frames) {
  const std::string text = frames_text(frames);
  if (auto check = parse_frames(text, path); !check) {
    return std::unexpected(std::move(check).error());
  }
  return write_text_file(path, text);
}

}  // namespace armsig::tool
