// SPDX-License-Identifier: MIT
#include "firmware/formats/yaml_map.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/characters.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

// What a value looks like in a message: the text itself, or "a map", "a list", "nothing".
std::string seen(const YamlNode& node) {
  return node.kind == YamlNode::Kind::kScalar ? in_quotes(node.text)
                                              : std::string(word_of(node.kind));
}

std::unexpected<Problem> unknown_key(const YamlNode& key, const std::string& map,
                                     const std::vector<std::string>& known) {
  std::vector<std::string> with_unit;
  std::ranges::copy_if(known, std::back_inserter(with_unit),
                       [&](const std::string& name) { return name.starts_with(key.text + "_"); });
  if (!key.text.empty() && !with_unit.empty()) {
    return problem_at(key, fmt::format("key {} of {} has no unit", in_quotes(key.text), map),
                      any_of(with_unit));
  }
  const std::string meant = nearest(key.text, known);
  return problem_at(key, fmt::format("unknown key {} in {}", in_quotes(key.text), map),
                    meant.empty() ? any_of(known) : meant);
}

}  // namespace

std::unexpected<Problem> problem_at(const YamlNode& node, std::string what, std::string expected) {
  return problem_at(node.line, node.column, std::move(what), std::move(expected));
}

Read<double> read_number(const YamlNode& node, std::string_view what) {
  if (node.kind != YamlNode::Kind::kScalar) {
    return problem_at(node, fmt::format("{}: {}", what, word_of(node.kind)), "a number");
  }
  const auto value = parse_number(node.text);
  if (!value) {
    return problem_at(node, fmt::format("{}: {}", what, why_not_a_number(node.text)), "a number");
  }
  return *value;
}

Read<int> read_integer(const YamlNode& node, std::string_view what, int lowest, int highest) {
  const auto value = node.kind == YamlNode::Kind::kScalar ? parse_integer(node.text) : std::nullopt;
  if (!value || *value < lowest || *value > highest) {
    return problem_at(node, fmt::format("{}: {}", what, seen(node)),
                      fmt::format("an integer from {} to {}", lowest, highest));
  }
  return *value;
}

Read<std::string> read_text(const YamlNode& node, std::string_view what) {
  if (node.kind != YamlNode::Kind::kScalar || node.text.empty()) {
    return problem_at(node, fmt::format("{}: {}", what, seen(node)), "text");
  }
  return node.text;
}

Read<std::string> read_name(const YamlNode& node, std::string_view what) {
  if (node.kind != YamlNode::Kind::kScalar) {
    return problem_at(node, fmt::format("{}: {}", what, word_of(node.kind)),
                      "text, \"\" where there is none");
  }
  if (const auto why = why_no_name(node.text)) {
    return problem_at(node, fmt::format("{}: {}", what, *why), std::string(kNameExpected));
  }
  return node.text;
}

Read<const std::vector<YamlNode>*> read_list(const YamlNode& node, std::string_view what,
                                             std::size_t lowest, std::size_t highest) {
  const std::string expected = lowest == highest
                                   ? fmt::format("a list of {} items", lowest)
                                   : fmt::format("a list of {} to {} items", lowest, highest);
  if (node.kind != YamlNode::Kind::kSequence) {
    return problem_at(node, fmt::format("{}: {}", what, seen(node)), expected);
  }
  if (node.items.size() < lowest || node.items.size() > highest) {
    return problem_at(
        node,
        fmt::format("{}: {} item{}", what, node.items.size(), node.items.size() == 1 ? "" : "s"),
        expected);
  }
  return &node.items;
}

Read<std::vector<double>> read_numbers(const YamlNode& node, std::string_view what,
                                       std::size_t count) {
  ARMSIG_TRY(items, read_list(node, what, count, count));
  std::vector<double> values;
  values.reserve(count);
  for (const YamlNode& item : *items) {
    ARMSIG_TRY(value, read_number(item, what));
    values.push_back(value);
  }
  return values;
}

Read<Vector3> read_vector3(const YamlNode& node, std::string_view what) {
  ARMSIG_TRY(values, read_numbers(node, what, 3));
  return Vector3(values[0], values[1], values[2]);
}

Vector3 direction_of(const Vector3& v) {
  constexpr double kRounding = 1e-14;
  const double length = v.stableNorm();
  if (!(length > 0)) return Vector3::Zero();
  return std::abs(length - 1) <= kRounding ? v : v.stableNormalized();
}

Read<YamlMap> YamlMap::open(const YamlNode& node, std::string name,
                            const std::vector<std::string>& known) {
  if (node.kind != YamlNode::Kind::kMap) {
    return problem_at(node, fmt::format("{} is {}", name, seen(node)), "a map of keys and values");
  }
  for (const YamlNode& key : node.keys) {
    if (std::ranges::find(known, key.text) == known.end()) return unknown_key(key, name, known);
  }
  return YamlMap(node, std::move(name));
}

Read<const YamlNode*> YamlMap::require(std::string_view key) const {
  const YamlNode* value = find(key);
  if (value == nullptr) {
    return problem_at(*node_, fmt::format("{} has no key \"{}\"", name_, key), std::string(key));
  }
  return value;
}

Read<std::optional<YamlQuantity>> YamlMap::find_quantity(std::string_view quantity,
                                                         Dimension dimension) const {
  std::optional<YamlQuantity> found;
  for (const Unit& unit : units_of(dimension)) {
    const std::string name = fmt::format("{}_{}", quantity, unit.suffix);
    const auto key = std::ranges::find(node_->keys, name, &YamlNode::text);
    if (key == node_->keys.end()) continue;
    if (found) {
      return problem_at(*key, fmt::format("{} and {} are both given", found->key->text, name),
                        "one of the two");
    }
    found = YamlQuantity{&*key, node_->find(name), unit};
  }
  return found;
}

Read<YamlQuantity> YamlMap::require_quantity(std::string_view quantity, Dimension dimension) const {
  ARMSIG_TRY(found, find_quantity(quantity, dimension));
  if (!found) {
    return problem_at(*node_, fmt::format("{} has no key \"{}\"", name_, quantity),
                      any_of(names_of(quantity, dimension)));
  }
  return *found;
}

Read<double> YamlMap::number(std::string_view key) const {
  ARMSIG_TRY(node, require(key));
  return read_number(*node, key);
}

Read<int> YamlMap::integer(std::string_view key, int lowest, int highest) const {
  ARMSIG_TRY(node, require(key));
  return read_integer(*node, key, lowest, highest);
}

Read<std::string> YamlMap::text(std::string_view key) const {
  ARMSIG_TRY(node, require(key));
  return read_text(*node, key);
}

Read<std::string> YamlMap::name_under(std::string_view key) const {
  ARMSIG_TRY(node, require(key));
  if (auto text = read_text(*node, key); !text) return text;
  return read_name(*node, key);
}

Read<Vector3> YamlMap::vector3(std::string_view key) const {
  ARMSIG_TRY(node, require(key));
  return read_vector3(*node, key);
}

Read<double> YamlMap::quantity(std::string_view quantity, Dimension dimension) const {
  ARMSIG_TRY(found, require_quantity(quantity, dimension));
  ARMSIG_TRY(value, read_number(*found.value, found.key->text));
  return found.unit.to_si(value);
}

Read<void> check_tag(const YamlNode& root, std::string_view tag) {
  const YamlNode* found = root.find("armsig");
  if (found == nullptr) {
    return problem_at(root, "the file does not say what it is",
                      fmt::format("armsig: {} as its first line", tag));
  }
  if (found->kind != YamlNode::Kind::kScalar || found->text != tag) {
    return problem_at(*found, "armsig: " + seen(*found), fmt::format("armsig: {}", tag));
  }
  return {};
}

void add_names(std::vector<std::string>& known, std::string_view quantity, Dimension dimension) {
  for (std::string& name : names_of(quantity, dimension)) known.push_back(std::move(name));
}

}  // namespace armsig::tool
