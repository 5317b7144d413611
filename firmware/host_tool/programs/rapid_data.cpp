// SPDX-License-Identifier: MIT
#include "firmware/host_tool/programs/rapid_data.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace armsig::tool {
namespace {

bool has_sizes(const RapidData& data, std::initializer_list<std::size_t> sizes) {
  return std::ranges::equal(data.lists, sizes, {}, [](const auto& list) { return list.size(); });
}

}  // namespace

std::optional<std::vector<std::vector<Bytes>>> rapid_lists(ProgramScanner& scanner) {
  std::vector<std::vector<Bytes>> lists;
  if (!scanner.accept('[')) return std::nullopt;
  do {
    auto one = scanner.list('[', ']');
    if (!one) return std::nullopt;
    lists.push_back(std::move(*one));
  } while (scanner.accept(','));
  if (!scanner.accept(']')) return std::nullopt;
  return lists;
}

std::optional<RapidData> rapid_target_at(std::string_view text, std::size_t& at) {
  ProgramScanner scanner(text, at);
  auto lists = rapid_lists(scanner);
  if (!lists) return std::nullopt;
  RapidData data{std::move(*lists), false};
  data.joints = has_sizes(data, {6, 6});
  if (!data.joints && !has_sizes(data, {3, 4, 4, 6})) return std::nullopt;
  at = scanner.at();
  return data;
}

std::vector<RapidData> rapid_targets(std::string_view text, Bytes bytes) {
  std::vector<RapidData> all;
  text = text.substr(0, bytes.end);
  for (std::size_t at = text.find('[', bytes.begin); at != std::string_view::npos;) {
    std::size_t behind = at;
    auto one = rapid_target_at(text, behind);
    if (one) all.push_back(std::move(*one));
    at = text.find('[', one ? behind : at + 1);
  }
  return all;
}

Bytes without_rapid_switches(std::string_view text, Bytes argument) {
  int depth = 0;
  for (std::size_t at = argument.begin; at < argument.end; ++at) {
    if (text[at] == '(' || text[at] == '[') ++depth;
    if (text[at] == ')' || text[at] == ']') --depth;
    if (depth == 0 && text[at] == '\\') return trimmed_bytes(text, {argument.begin, at});
  }
  return argument;
}

}  // namespace armsig::tool
