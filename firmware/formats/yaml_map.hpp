// SPDX-License-Identifier: MIT
// Strict access to the maps of a YAML tree: every key known, every needed key present, every number
// a finite number in a stated unit. Each refusal is a Problem with its place.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/units.hpp"
#include "firmware/formats/yaml_tree.hpp"

namespace armsig::tool {

[[nodiscard]] std::unexpected<Problem> problem_at(const YamlNode& node, std::string what,
                                                  std::string expected);

// The finite number in `node`; `what` names it in the message ("ratio").
[[nodiscard]] Read<double> read_number(const YamlNode& node, std::string_view what);

[[nodiscard]] Read<int> read_integer(const YamlNode& node, std::string_view what, int lowest,
                                     int highest);

// A text that is not empty.
[[nodiscard]] Read<std::string> read_text(const YamlNode& node, std::string_view what);

// A name, serial number or version: a text of at most kLongestName bytes, which may be empty.
[[nodiscard]] Read<std::string> read_name(const YamlNode& node, std::string_view what);

// A list of exactly `count` finite numbers.
[[nodiscard]] Read<std::vector<double>> read_numbers(const YamlNode& node, std::string_view what,
                                                     std::size_t count);

[[nodiscard]] Read<Vector3> read_vector3(const YamlNode& node, std::string_view what);

// `v` scaled to length 1, and 0 if it has no length. One of length 1, to rounding, is taken as it
// is, so that what is written is read as the same bits.
[[nodiscard]] Vector3 direction_of(const Vector3& v);

// The items of a list of `lowest` to `highest` items.
[[nodiscard]] Read<const std::vector<YamlNode>*> read_list(const YamlNode& node,
                                                           std::string_view what,
                                                           std::size_t lowest, std::size_t highest);

// A value with the unit that its key names.
struct YamlQuantity {
  const YamlNode* key = nullptr;
  const YamlNode* value = nullptr;
  Unit unit;
};

class YamlMap {
 public:
  // `name` stands for the map in messages ("joint 3"). Refuses what is no map and, with the nearest
  // known key, a key that is not among `known`.
  [[nodiscard]] static Read<YamlMap> open(const YamlNode& node, std::string name,
                                          const std::vector<std::string>& known);

  [[nodiscard]] const YamlNode* find(std::string_view key) const { return node_->find(key); }
  [[nodiscard]] Read<const YamlNode*> require(std::string_view key) const;

  // quantity_unit for exactly one of the units; find_quantity: or for none of them.
  [[nodiscard]] Read<YamlQuantity> require_quantity(std::string_view quantity,
                                                    Dimension dimension) const;
  [[nodiscard]] Read<std::optional<YamlQuantity>> find_quantity(std::string_view quantity,
                                                                Dimension dimension) const;

  [[nodiscard]] Read<double> number(std::string_view key) const;
  [[nodiscard]] Read<int> integer(std::string_view key, int lowest, int highest) const;
  [[nodiscard]] Read<std::string> text(std::string_view key) const;
  // The name under `key`, not empty.
  [[nodiscard]] Read<std::string> name_under(std::string_view key) const;
  [[nodiscard]] Read<Vector3> vector3(std::string_view key) const;
  // The number of quantity_unit, in SI.
  [[nodiscard]] Read<double> quantity(std::string_view quantity, Dimension dimension) const;

  [[nodiscard]] const YamlNode& node() const { return *node_; }
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  YamlMap(const YamlNode& node, std::string name) : node_(&node), name_(std::move(name)) {}

  const YamlNode* node_;
  std::string name_;
};

// Refuses a document whose `armsig` key is absent or does not say `tag` ("arm/1").
[[nodiscard]] Read<void> check_tag(const YamlNode& root, std::string_view tag);

// Appends all unit variants of a quantity to a list of known keys.
void add_names(std::vector<std::string>& known, std::string_view quantity, Dimension dimension);

}  // namespace armsig::tool
