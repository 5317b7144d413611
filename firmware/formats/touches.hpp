// SPDX-License-Identifier: MIT
// Touches (CSV): joint readings with the name of the place that the tool was at, and the length
// where a wire was read (docs/formats.md).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/formats/instrument_file.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct Touch {
  std::size_t line = 0;  // of the file, from 1
  std::string place;
  JointVector q;        // as read: couplings not applied
  double length_m = 0;  // of a wire
};

// Whether a place has a name that a console, a spreadsheet and a live page take for nothing else: a
// letter or digit, then letters, digits, `_`, `-` and `.`. A file may have other names.
inline constexpr std::size_t kLongestPlace = 32;  // characters
[[nodiscard]] bool is_place_name(std::string_view name);
inline constexpr std::string_view kPlaceExpected =
    "a letter or digit, then letters, digits, _, - and ., at most 32 in all";

// Refuses a place without a name, a wire without a length, a length where none belongs, and a file
// without any row.
[[nodiscard]] Read<std::vector<Touch>> read_touches(const std::string& path,
                                                    const JointTypes& types,
                                                    const InstrumentDescription& description);
[[nodiscard]] Read<std::vector<Touch>> parse_touches(std::string_view text, std::string_view file,
                                                     const JointTypes& types,
                                                     const InstrumentDescription& description);

// The same as a table for a person: to a thousandth of a degree or millimetre. A column of lengths
// where the description has wires.
[[nodiscard]] std::string touches_text(std::span<const Touch> touches, const JointTypes& types,
                                       const InstrumentDescription& description);

}  // namespace armsig::tool
