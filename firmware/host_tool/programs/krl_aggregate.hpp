// SPDX-License-Identifier: MIT
// Aggregates of KRL: {X 1, Y 2, ...}.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host_tool/programs/program_text.hpp"

namespace armsig::tool {

inline constexpr std::array<std::string_view, 6> kPoseNames{"X", "Y", "Z", "A", "B", "C"};
inline constexpr std::array<std::string_view, 6> kAxisNames{"A1", "A2", "A3", "A4", "A5", "A6"};

// {NAME number, ...}; what is no number is not among them.
struct KrlAggregate {
  std::size_t at = 0;
  std::size_t end = 0;
  std::map<std::string, Bytes> numbers;
  std::map<std::string, Bytes> bits;  // as 'B110' or 'H1F'

  // Those of `names`; nothing where one is missing.
  [[nodiscard]] std::optional<std::vector<Bytes>> all(
      std::span<const std::string_view> names) const;
  [[nodiscard]] bool is_target() const { return all(kPoseNames) || all(kAxisNames); }
};

// `at`: of the brace. It ends with its line at the latest.
[[nodiscard]] KrlAggregate krl_aggregate_at(std::string_view text, std::size_t at);

// The value of 'B110' or 'H1F'; 0 of what is neither.
[[nodiscard]] long krl_bits(std::string_view text);

}  // namespace armsig::tool
