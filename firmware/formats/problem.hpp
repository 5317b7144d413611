// SPDX-License-Identifier: MIT
// What is wrong with a file, for the person who has to mend it: where, what was found, what was
// expected.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <utility>

namespace armsig::tool {

struct Problem {
  std::string file;
  int line = 0;    // from 1; 0 where no line is to blame
  int column = 0;  // from 1; 0 where the whole line is
  std::string what;
  std::string expected;  // empty where `what` says it all
};

template <typename T>
using Read = std::expected<T, Problem>;

// "file:line:column: what; expected ..." on one line, what is not printable escaped.
[[nodiscard]] std::string render(const Problem& problem);

// A problem at a place inside a file whose name the caller adds with in_file.
[[nodiscard]] std::unexpected<Problem> problem_at(int line, int column, std::string what,
                                                  std::string expected);

// `read`, its problem completed by the name of the file.
template <typename T>
[[nodiscard]] Read<T> in_file(std::string_view file, Read<T> read) {
  if (!read && read.error().file.empty()) read.error().file = file;
  return read;
}

}  // namespace armsig::tool
