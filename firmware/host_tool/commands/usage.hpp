// SPDX-License-Identifier: MIT
// What is wrong with a command line, and what was most likely meant.
#pragma once

#include <span>
#include <string>

#include <CLI/CLI.hpp>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// Of the words after `armsig` that CLI11 refused with `error`: a command or an option that there is
// not, or one of an option's words, each with the nearest that there is.
[[nodiscard]] Problem usage_problem(const CLI::App& app, const CLI::ParseError& error,
                                    std::span<const std::string> words);

}  // namespace armsig::tool
