// SPDX-License-Identifier: MIT
#include "firmware/command_line/option_problem.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/core.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

// A word of an option that is none of its words: "--format: udrf not in {urdf,json}".
std::optional<Problem> wrong_word(std::string_view message) {
  constexpr std::string_view kNotIn = " not in {";
  const std::size_t at = message.find(kNotIn);
  const std::size_t end = message.rfind('}');
  const std::size_t colon = message.find(": ");
  if (at == std::string_view::npos || end == std::string_view::npos || colon >= at) {
    return std::nullopt;
  }
  std::string_view list = message.substr(at + kNotIn.size(), end - at - kNotIn.size());
  std::vector<std::string> words;
  while (!list.empty()) {
    const std::size_t comma = std::min(list.find(','), list.size());
    words.emplace_back(list.substr(0, comma));
    list.remove_prefix(std::min(comma + 1, list.size()));
  }
  const std::string word(message.substr(colon + 2, at - colon - 2));
  return wrong_usage(
      fmt::format("{}: {} is none of its words", message.substr(0, colon), in_quotes(word)),
      nearest_or(word, words, any_of(words)));
}

// "--count: Value 0 not in range 1 to 1000"; a range without an end goes to the largest double.
std::optional<Problem> out_of_range(const CLI::App& command, std::string_view message) {
  constexpr std::string_view kValue = ": Value ";
  constexpr std::string_view kNotIn = " not in range ";
  constexpr std::string_view kTo = " to ";
  constexpr double kEndless = 1e300;
  const std::size_t value = message.find(kValue);
  const std::size_t range = message.rfind(kNotIn);
  const std::size_t to = message.rfind(kTo);
  if (value == std::string_view::npos || range == std::string_view::npos || to < range) {
    return std::nullopt;
  }
  const std::size_t begin = range + kNotIn.size();
  const auto low = parse_number(message.substr(begin, to - begin));
  const auto high = parse_number(message.substr(to + kTo.size()));
  if (!low || !high) return std::nullopt;
  const std::string option(message.substr(0, value));
  const std::string_view word =
      message.substr(value + kValue.size(), range - value - kValue.size());
  std::string expected = fmt::format("a number from {} to {}", *low, *high);
  if (*high > kEndless) {
    const CLI::Option* one = command.get_option_no_throw(option);
    const bool above = one != nullptr && one->get_type_name().find(":POS") != std::string::npos;
    expected = above ? "a number above 0" : "0 or more";
  }
  return wrong_usage(fmt::format("{}: {}", option,
                                 parse_number(word) ? in_quotes(word) + " is out of its range"
                                                    : why_not_a_number(word)),
                     std::move(expected));
}

constexpr std::string_view kNotFinite = " is not a finite number";

std::optional<Problem> not_finite(std::string_view message) {
  if (!message.ends_with(kNotFinite)) return std::nullopt;
  return wrong_usage(std::string(message), "a number");
}

// Words that are no number at all are left to the parser, which says so.
std::string refused_where_not_finite(const std::string& word) {
  const std::string why = parse_number(word) ? "" : why_not_a_number(word);
  return why.ends_with(kNotFinite) ? why : "";
}

}  // namespace

Problem wrong_usage(std::string what, std::string expected) {
  return {"", 0, 0, std::move(what), std::move(expected)};
}

std::string nearest_or(const std::string& word, const std::vector<std::string>& known,
                       std::string otherwise) {
  std::string meant = nearest(word, known);
  if (meant.empty()) return otherwise;
  return meant;
}

std::optional<Problem> unknown_option(const CLI::App& command, std::string_view called,
                                      std::span<const std::string> words) {
  const std::vector<std::string> known = options_of(command);
  for (const std::string& word : words) {
    const std::string name = word.substr(0, word.find('='));
    if (!name.starts_with("--") || name == "--" || std::ranges::find(known, name) != known.end()) {
      continue;
    }
    return wrong_usage(fmt::format("{} has no option {}", called, in_quotes(name)),
                       nearest_or(name, known, fmt::format("one that {} --help lists", called)));
  }
  return std::nullopt;
}

Problem option_problem(const CLI::App& command, std::string_view called,
                       const CLI::ParseError& error, std::span<const std::string> words) {
  if (auto unknown = unknown_option(command, called, words)) return *unknown;
  const std::string message = error.what();
  if (auto wrong = wrong_word(message)) return *wrong;
  if (auto wrong = out_of_range(command, message)) return *wrong;
  if (auto wrong = not_finite(message)) return *wrong;
  return wrong_usage(message, fmt::format("what {} --help says", called));
}

void demand_finite_numbers(CLI::App& app) {
  for (CLI::App* command : app.get_subcommands({})) demand_finite_numbers(*command);
  for (CLI::Option* option : app.get_options()) {
    // The type of an option with a check is followed by the check's name.
    if (option->get_type_name().starts_with("FLOAT")) {
      option->check(CLI::Validator(refused_where_not_finite, ""));
    }
  }
}

}  // namespace armsig::tool
