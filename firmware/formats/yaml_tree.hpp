// SPDX-License-Identifier: MIT
// A YAML document as a plain tree whose every node knows its place in the file.
//
// yaml-cpp does the parsing; its own Node loses the places of keys, keeps the first of two equal
// keys, and throws on access. Only the part of YAML that our files use is let in: maps with
// distinct text keys, sequences, scalars of printable characters; no anchors, aliases or tags, one
// document a file, 16 levels, 250,000 lines, commas, colons, quotes and brackets.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct YamlNode {
  enum class Kind : std::uint8_t { kEmpty, kScalar, kSequence, kMap };

  Kind kind = Kind::kEmpty;
  int line = 0;  // both from 1
  int column = 0;
  bool plain = false;           // a scalar without quotes
  std::string text;             // of a scalar
  std::vector<YamlNode> keys;   // of a map: scalars, as many as items
  std::vector<YamlNode> items;  // of a map (its values) or of a sequence

  // The value of `key` in a map; null where it has none or this is no map.
  [[nodiscard]] const YamlNode* find(std::string_view key) const;
};

// The document in `text`; the caller names the file in the problem. Stops at the first problem.
[[nodiscard]] Read<YamlNode> parse_yaml(std::string_view text);

// "a map", "a list", "text", "nothing".
[[nodiscard]] std::string_view word_of(YamlNode::Kind kind);

// `text` as a double-quoted YAML scalar; bytes that are no UTF-8 become U+FFFD.
[[nodiscard]] std::string yaml_quoted(std::string_view text);

}  // namespace armsig::tool
