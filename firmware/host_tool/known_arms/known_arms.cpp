// SPDX-License-Identifier: MIT
#include "firmware/host_tool/known_arms/known_arms.hpp"

#include <algorithm>
#include <filesystem>
#include <vector>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return lower;
}

// A file that exists, or words that no known arm could be called by.
bool is_a_path(const std::string& text) {
  std::error_code error;
  return std::filesystem::exists(text, error) || text.find_first_of("/.") != std::string::npos;
}

}  // namespace

std::string source_of(const KnownArm& arm) {
  std::string source;
  std::string_view rest = arm.text;
  while (rest.starts_with("# ")) {
    const std::size_t end = rest.find('\n');
    source += fmt::format("{}{}", source.empty() ? "" : " ", rest.substr(2, end - 2));
    rest.remove_prefix(end + 1);
  }
  return source;
}

const KnownArm* find_known_arm(std::string_view name) {
  const std::span<const KnownArm> arms = known_arms();
  const auto found = std::ranges::find(arms, in_lower_case(name), &KnownArm::name);
  return found == arms.end() ? nullptr : &*found;
}

std::string known_arm_like(std::string_view name, std::string_view otherwise) {
  std::vector<std::string> names;
  for (const KnownArm& arm : known_arms()) names.emplace_back(arm.name);
  const std::string meant = nearest(in_lower_case(name), names);
  return meant.empty() ? std::string(otherwise)
                       : fmt::format("{}, or another that `armsig arms` lists", meant);
}

Read<ArmDescription> read_arm(const std::string& file_or_name) {
  if (is_a_path(file_or_name)) return read_arm_file(file_or_name);
  if (const KnownArm* arm = find_known_arm(file_or_name)) return parse_arm(arm->text, arm->name);
  return std::unexpected(
      Problem{file_or_name, 0, 0, "neither a file nor a known arm",
              known_arm_like(file_or_name, "a file, or a name that `armsig arms` lists")});
}

}  // namespace armsig::tool
