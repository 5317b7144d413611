// SPDX-License-Identifier: MIT
// Taught frames for a person and for a program.
#pragma once

#include <nlohmann/json.hpp>

#include "firmware/formats/frames_file.hpp"
#include "firmware/host_tool/programs/program.hpp"
#include "firmware/host_tool/taught_frames/taught_frames.hpp"

namespace armsig::tool {

// `language`: whose controller takes the frames; orientations are written as it writes them.
void print_taught_frames(const TaughtTask& task, const TaughtFrames& result,
                         const Language& language);
[[nodiscard]] nlohmann::ordered_json json_of(const TaughtTask& task, const TaughtFrames& result,
                                             const Language& language);

// The frames of the found model, each with the forms in which controllers have it.
[[nodiscard]] FramesFile file_of(const TaughtTask& task, const TaughtFrames& result);

}  // namespace armsig::tool
