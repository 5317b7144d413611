// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/wrapping.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

namespace armsig::tool {
namespace {

constexpr std::size_t kDefaultWidth = 80;

}  // namespace

std::size_t output_width() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
      size.ws_col == 0) {
    return kDefaultWidth;
  }
  return size.ws_col;
}

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

}  // namespace armsig::tool
