// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/entries.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "firmware/formats/wrapping.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kNameColumn = 16;
constexpr std::size_t kNarrowestEntry = 40;

}  // namespace

Entries::Entries(std::size_t width) : text_width_(std::max(width, kNarrowestEntry) - kNameColumn) {}

void Entries::add_line(std::string_view name, std::string_view text) {
  lines_ += fmt::format("  {:<{}}{}\n", name, kNameColumn - 2, text);
}

void Entries::add(std::string_view name, std::string_view text) {
  if (text.empty()) return;
  for (const std::string& line : wrapped(text, text_width_)) {
    add_line(name, line);
    name = "";
  }
}

}  // namespace armsig::tool
