// SPDX-License-Identifier: MIT
// A robtarget or jointtarget that RAPID writes out: [[...], [...], ...].
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "firmware/host_tool/programs/program_text.hpp"

namespace armsig::tool {

struct RapidData {
  std::vector<std::vector<Bytes>> lists;
  bool joints = false;
};

// [[...], [...], ...] of numbers.
[[nodiscard]] std::optional<std::vector<std::vector<Bytes>>> rapid_lists(ProgramScanner& scanner);

// A robtarget or jointtarget written out from `at`, and where it ends.
[[nodiscard]] std::optional<RapidData> rapid_target_at(std::string_view text, std::size_t& at);

// Those between `bytes`: of an array, one for each element.
[[nodiscard]] std::vector<RapidData> rapid_targets(std::string_view text, Bytes bytes);

// The argument without its switches: "P10" of "P10\ID:=3". Those within parentheses stay.
[[nodiscard]] Bytes without_rapid_switches(std::string_view text, Bytes argument);

}  // namespace armsig::tool
