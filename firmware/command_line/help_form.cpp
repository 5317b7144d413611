// SPDX-License-Identifier: MIT
#include "firmware/command_line/help_form.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <fmt/format.h>

namespace armsig::tool {
namespace {

// CLI11 names a type, a colon, and the checks of its value: "TEXT:{csv,json}", "FLOAT:FLOAT in [0 -
// 20]".
struct TypeName {
  explicit TypeName(std::string_view name)
      : type(name.substr(0, name.find(':'))),
        check(name.substr(std::min(type.size() + 1, name.size()))) {}

  [[nodiscard]] bool is_number() const {
    return type == "FLOAT" || type == "INT" || type == "UINT";
  }
  [[nodiscard]] std::string words() const {
    if (!check.starts_with('{')) return {};
    std::string list(check.substr(1, check.find('}') - 1));
    std::ranges::replace(list, ',', '|');
    return list;
  }
  [[nodiscard]] std::string range() const {
    if (check.starts_with("POSITIVE")) return "above 0";
    if (check.starts_with("NONNEGATIVE")) return "0 or more";
    const std::size_t begin = check.find('[');
    const std::size_t dash = check.find(" - ");
    const std::size_t end = check.find(']');
    if (begin == std::string_view::npos || dash == std::string_view::npos || end < dash) return {};
    return fmt::format("{} to {}", check.substr(begin + 1, dash - begin - 1),
                       check.substr(dash + 3, end - dash - 3));
  }

  std::string_view type;
  std::string_view check;
};

bool is_of_a_file(std::string_view description) {
  constexpr std::array<std::string_view, 6> kMarks{"(YAML",    "(CSV",   "(HTML",
                                                   "to write", "a file", "log:"};
  return std::ranges::any_of(kMarks,
                             [&](std::string_view mark) { return description.contains(mark); });
}

std::string names_of(const std::set<CLI::Option*>& options) {
  std::string names;
  for (const CLI::Option* option : options) {
    names += (names.empty() ? "" : ", ") + option->get_name();
  }
  return names;
}

}  // namespace

HelpForm::HelpForm() { column_width(30); }

std::string HelpForm::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0) return {};
  const std::string name = option->get_type_name();
  const TypeName type(name);
  std::string taken = type.words();
  if (taken.empty()) {
    taken = type.is_number() ? "NUMBER" : std::string(type.type);
    if (type.type == "TEXT" && is_of_a_file(option->get_description())) taken = "FILE";
  }
  const bool is_list = option->get_expected_max() == CLI::detail::expected_max_vector_size;
  return " " + taken + (is_list ? " ..." : "");
}

std::string HelpForm::make_option_desc(const CLI::Option* option) const {
  std::string text = option->get_description();
  const auto add = [&](std::string_view what, const std::string& value) {
    if (!value.empty()) text += fmt::format(" ({}{})", what, value);
  };
  if (option->get_required()) add("", "required");
  if (option->get_type_size() != 0) {
    const std::string name = option->get_type_name();
    const TypeName type(name);
    if (option->get_expected_min() > 1)
      add("", fmt::format("{} numbers", option->get_expected_min()));
    if (type.is_number()) add("", type.range());
    add("default ", option->get_default_str());
  }
  add("with ", names_of(option->get_needs()));
  add("not with ", names_of(option->get_excludes()));
  return text;
}

}  // namespace armsig::tool
