// SPDX-License-Identifier: MIT
// The reader of each language, and how it writes poses.
#pragma once

#include <string>
#include <string_view>

#include "firmware/host_tool/programs/program.hpp"

namespace armsig::tool {

inline constexpr Writing kUrWriting{.angles = Angles::kRotationVector,
                                    .metres = 1,
                                    .radians = 1,
                                    .length_decimals = 9,
                                    .angle_decimals = 10};
inline constexpr Writing kRapidWriting{.angles = Angles::kQuaternion,
                                       .radians = radians(1.0),
                                       .length_decimals = 6,
                                       .angle_decimals = 10};
inline constexpr Writing kKrlWriting{
    .angles = Angles::kAbc, .radians = radians(1.0), .length_decimals = 6, .angle_decimals = 8};

inline constexpr Writing kFanucWriting{
    .angles = Angles::kRpy, .radians = radians(1.0), .length_decimals = 6, .angle_decimals = 8};
inline constexpr Writing kJbiWriting = kFanucWriting;
inline constexpr Writing kGcodeWriting = kFanucWriting;

// What is said of a target whose tool the program does not say.
inline constexpr const char* kNoTool = "the program does not say its tool: --tool";
inline constexpr const char* kNoFrame = "the program does not say its frame: --frame";

[[nodiscard]] Program read_urscript(std::string_view text, const ProgramFrames& frames);
[[nodiscard]] Program read_rapid(std::string_view text, const ProgramFrames& frames);
[[nodiscard]] Program read_krl(std::string_view text, const ProgramFrames& frames);
[[nodiscard]] Program read_fanuc(std::string_view text, const ProgramFrames& frames);
[[nodiscard]] Program read_gcode(std::string_view text, const ProgramFrames& frames);
[[nodiscard]] Program read_jbi(std::string_view text, const ProgramFrames& frames);

}  // namespace armsig::tool
