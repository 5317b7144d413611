// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/usage.hpp"

#include <algorithm>
#include <vector>

#include "firmware/command_line/option_problem.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

std::vector<std::string> commands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

const CLI::App* command_called(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_name() == name) return command;
  }
  return nullptr;
}

}  // namespace

Problem usage_problem(const CLI::App& app, const CLI::ParseError& error,
                      std::span<const std::string> words) {
  const auto is_option = [](const std::string& word) { return word.starts_with('-'); };
  const auto first = std::ranges::find_if_not(words, is_option);
  const auto before = words.first(static_cast<std::size_t>(first - words.begin()));
  if (auto unknown = unknown_option(app, "armsig", before)) return *unknown;
  if (first == words.end()) {
    return words.empty() ? wrong_usage("no command", "one that armsig --help lists")
                         : wrong_usage("armsig has no option " + in_quotes(words[0]),
                                       "what armsig --help lists");
  }
  const CLI::App* const command = command_called(app, *first);
  if (command == nullptr) {
    return wrong_usage(in_quotes(*first) + " is no command",
                       nearest_or(*first, commands_of(app), "one that armsig --help lists"));
  }
  return option_problem(*command, "armsig " + *first, error, words.subspan(before.size() + 1));
}

}  // namespace armsig::tool
