// SPDX-License-Identifier: MIT
#include "firmware/formats/wrapping.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <optional>

namespace armsig::tool {
namespace {

constexpr std::size_t kDefaultWidth = 80;

// That of the terminal that `file` is, or nothing; a terminal may not know its width.
std::optional<std::size_t> terminal_width(int file) {
  if (isatty(file) == 0) return std::nullopt;
  winsize size{};
  if (ioctl(file, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return kDefaultWidth;
  return size.ws_col;
}

}  // namespace

std::size_t output_width() { return terminal_width(STDOUT_FILENO).value_or(kDefaultWidth); }

std::size_t width_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

Lines wrapped(std::string_view text, std::size_t width) {
  Lines lines{""};
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t stop = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, stop - at);
    if (lines.back().empty()) {
      lines.back() = word;
    } else if (width_of(lines.back()) + 1 + width_of(word) <= width) {
      lines.back() += ' ';
      lines.back() += word;
    } else {
      lines.emplace_back(word);
    }
    at = stop + 1;
  }
  return lines;
}

std::string paragraph(std::string_view text, std::size_t indent, std::size_t width) {
  std::string lines;
  for (const std::string& line : wrapped(text, std::max(width, indent + 1) - indent)) {
    lines += std::string(indent, ' ') + line + '\n';
  }
  return lines;
}

std::string for_standard_error(std::string_view text) {
  constexpr std::size_t kIndent = 2;
  const auto width = terminal_width(STDERR_FILENO);
  if (!width || width_of(text) <= *width) return std::string(text) + '\n';
  return paragraph(text, kIndent, *width).substr(kIndent);
}

}  // namespace armsig::tool
