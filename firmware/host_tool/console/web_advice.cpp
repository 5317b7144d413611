// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_advice.hpp"

#include <array>
#include <map>
#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/error_name.hpp"
#include "firmware/host_tool/console/web_files.hpp"

namespace armsig::tool {
namespace {

struct Advice {
  std::string_view happened;
  std::string_view todo;
};

// The cells of a row "| message | what happened | what to do |".
std::array<std::string_view, 3> cells_of(std::string_view row) {
  std::array<std::string_view, 3> cells;
  std::size_t at = 2;
  for (std::string_view& cell : cells) {
    const std::size_t end = row.find(" |", at);
    if (end == std::string_view::npos) break;
    cell = row.substr(at, end - at);
    at = end + 3;
  }
  return cells;
}

std::map<std::string_view, Advice> table() {
  std::map<std::string_view, Advice> table;
  std::string_view rest = kMessages;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (!line.starts_with("| ")) continue;
    const auto [message, happened, todo] = cells_of(line);
    table[message] = {happened, todo};
  }
  return table;
}

}  // namespace

nlohmann::ordered_json web_advice() {
  const auto known = table();
  auto advice = nlohmann::ordered_json::object();
  for (int value = 0; value < 256; ++value) {
    const auto error = static_cast<Error>(value);
    const auto found = known.find(describe(error));
    if (found == known.end()) continue;
    advice[std::string(name(error))] = {{"words", found->first},
                                        {"happened", found->second.happened},
                                        {"todo", found->second.todo}};
  }
  return advice;
}

}  // namespace armsig::tool
