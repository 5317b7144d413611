// SPDX-License-Identifier: MIT
// Tools and work objects by name, frames/1 (docs/formats.md).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

inline constexpr std::string_view kFramesTag = "frames/1";

struct NamedPose {
  std::string name;
  Pose X;
  std::vector<std::string> forms;  // as controllers have it, one a line: written, never read
};

struct FramesFile {
  std::vector<NamedPose> tools;         // on the controller's flange
  std::vector<NamedPose> work_objects;  // in the controller's base
};

[[nodiscard]] Read<FramesFile> read_frames_file(const std::string& path);
[[nodiscard]] Read<FramesFile> parse_frames(std::string_view text, std::string_view file);

// In metres with 17 digits; reading it gives the same poses within rounding.
[[nodiscard]] std::string frames_text(const FramesFile& frames);

// Writes atomically; refuses what could not be read back.
[[nodiscard]] Read<void> write_frames_file(const std::string& path, const FramesFile& frames);

}  // namespace armsig::tool
