// SPDX-License-Identifier: MIT
// The CRC-32 that seals a signature file. It covers the content, not the layout: comments, order of
// keys, indentation and spelling of a number (0.5, 5e-1) are free, any other change is detected.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"
#include "firmware/formats/yaml_tree.hpp"

namespace armsig::tool {

inline constexpr std::string_view kCrcKey = "crc32";

// The canonical form of a document without its top-level crc32:
//   map       {key:value;key:value;}   keys in the order of their bytes
//   sequence  [item;item;]
//   number    printf %.17g, for an unquoted scalar that spells one; other scalars as they are
//   nothing   ~
[[nodiscard]] std::string canonical_text(const YamlNode& document);

// The CRC-32 of that form.
[[nodiscard]] std::uint32_t content_crc32(const YamlNode& document);

// `body` (YAML without a crc32) followed by its crc32 line. The body must be valid.
[[nodiscard]] Read<std::string> sealed(std::string body);

// Refuses a document without crc32, or whose content does not match it.
[[nodiscard]] Read<void> check_seal(const YamlNode& document);

}  // namespace armsig::tool
