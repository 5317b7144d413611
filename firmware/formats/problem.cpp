// SPDX-License-Identifier: MIT
#include "firmware/formats/problem.hpp"

#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {

std::string render(const Problem& problem) {
  std::string text = problem.file;
  if (problem.line > 0) text += fmt::format(":{}", problem.line);
  if (problem.line > 0 && problem.column > 0) text += fmt::format(":{}", problem.column);
  if (!text.empty()) text += ": ";
  text += problem.what;
  if (!problem.expected.empty()) text += "; expected " + problem.expected;
  return shown(text);
}

std::unexpected<Problem> problem_at(int line, int column, std::string what, std::string expected) {
  return std::unexpected(Problem{{}, line, column, std::move(what), std::move(expected)});
}

}  // namespace armsig::tool
