// SPDX-License-Identifier: MIT
#include "firmware/formats/terminal_line.hpp"

#include <unistd.h>

#include <cstdio>

namespace armsig::tool {
namespace {

constexpr const char* kEmptyLine = "\r\033[K";

}  // namespace

TerminalLine& TerminalLine::of_this_process() {
  static TerminalLine line;
  return line;
}

void TerminalLine::show(std::string_view text) {
  if (::isatty(STDERR_FILENO) != 1) return;
  is_shown_ = true;
  (void)std::fputs(kEmptyLine, stderr);
  (void)std::fwrite(text.data(), 1, text.size(), stderr);
}

void TerminalLine::clear() {
  if (!is_shown_) return;
  is_shown_ = false;
  (void)std::fputs(kEmptyLine, stderr);
}

}  // namespace armsig::tool
