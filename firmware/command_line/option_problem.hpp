// SPDX-License-Identifier: MIT
// What is wrong with the options of a command line, and what was most likely meant.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

[[nodiscard]] Problem wrong_usage(std::string what, std::string expected);

// The one of `known` that `word` is most likely mistyped from.
[[nodiscard]] std::string nearest_or(const std::string& word, const std::vector<std::string>& known,
                                     std::string otherwise);

// The first of `words` that is no option of `command`, which is called `called` in words.
[[nodiscard]] std::optional<Problem> unknown_option(const CLI::App& command,
                                                    std::string_view called,
                                                    std::span<const std::string> words);

// Of the words after `called` that CLI11 refused with `error`: an option that there is not, a word
// that is none of an option's, a number out of its range; otherwise as CLI11 says it.
[[nodiscard]] Problem option_problem(const CLI::App& command, std::string_view called,
                                     const CLI::ParseError& error,
                                     std::span<const std::string> words);

// No option of `app` and its commands that takes numbers takes "nan" or "inf": comparisons with a
// range let the former pass.
void demand_finite_numbers(CLI::App& app);

}  // namespace armsig::tool
