// SPDX-License-Identifier: MIT
// Infinity as files of other software spell it, for a limit that is none.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string_view>

#include "firmware/formats/text.hpp"

namespace armsig::tool {

// Of "inf", "-Inf", "+INF", "infinity"; nothing where `text` is anything else.
[[nodiscard]] inline std::optional<double> parse_infinity(std::string_view text) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr std::array<std::string_view, 5> kWords{"inf", "Inf", "INF", "infinity", "Infinity"};
  text = trimmed(text);
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (std::ranges::find(kWords, text) == kWords.end()) return std::nullopt;
  return negative ? -kInfinity : kInfinity;
}

}  // namespace armsig::tool
