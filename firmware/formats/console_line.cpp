// SPDX-License-Identifier: MIT
#include "firmware/formats/console_line.hpp"

#include <algorithm>

namespace armsig::tool {

std::optional<ConsoleLine::Value> ConsoleLine::next() {
  left_.remove_prefix(std::min(left_.find_first_not_of(' '), left_.size()));
  if (left_.empty()) return std::nullopt;
  const std::size_t end = std::min(left_.find(' '), left_.size());
  const std::size_t equals = left_.find('=');
  if (equals >= end) {
    const Value word{{}, left_.substr(0, end)};
    left_.remove_prefix(end);
    return word;
  }
  const std::string_view key = left_.substr(0, equals);
  left_.remove_prefix(equals + 1);
  const bool quoted = left_.starts_with('"');
  if (quoted) left_.remove_prefix(1);
  const std::size_t length = std::min(left_.find(quoted ? '"' : ' '), left_.size());
  const Value found{key, left_.substr(0, length)};
  left_.remove_prefix(std::min(length + (quoted ? 1 : 0), left_.size()));
  return found;
}

std::optional<std::string_view> value_in(std::string_view line, std::string_view key) {
  ConsoleLine words(line);
  while (const auto value = words.next()) {
    if (!key.empty() && value->key == key) return value->value;
  }
  return std::nullopt;
}

}  // namespace armsig::tool
