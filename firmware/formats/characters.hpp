// SPDX-License-Identifier: MIT
// Which characters a name, a header or a message may have. What a terminal, or a program that reads
// one of our files, could take for something else than text is refused where it enters and escaped
// where it leaves: control characters (C0, DEL, C1), line and paragraph separators (U+2028,
// U+2029), what turns the direction of writing (U+202A to U+202E, U+2066 to U+2069), a byte order
// mark inside a text, noncharacters, and bytes that are no UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

// One character of UTF-8 at the start of a text.
struct Character {
  std::size_t length = 0;  // in bytes; 0 where there is none
  std::uint32_t code = 0;
};
[[nodiscard]] Character first_character(std::string_view text);

// False for the characters above, tab, line feed and carriage return among them.
[[nodiscard]] bool is_printable(std::uint32_t code);

// The position of the first byte of what is not printable; nothing where all of `text` is.
[[nodiscard]] std::optional<std::size_t> first_unprintable(std::string_view text);

// `text` with \xNN for each byte that is no UTF-8 and each control character below U+0100, \uNNNN
// for what else is not printable. The same text where all of it is printable.
[[nodiscard]] std::string shown(std::string_view text);

// The same as text or as the value of an attribute of XML. (XML 1.0 has no way to write most
// control characters.)
[[nodiscard]] std::string markup_text(std::string_view text);

// shown(), line feeds kept.
[[nodiscard]] std::string shown_lines(std::string_view text);

// Names, serial numbers and versions are at most this long: formats that others read line by line
// hold a line of them, and nobody's name is longer.
inline constexpr std::size_t kLongestName = 200;  // bytes

// Why `text` can't be a name, serial number or version: too long, or a character that is not
// printable. It may be empty.
[[nodiscard]] std::optional<std::string> why_no_name(std::string_view text);
inline constexpr std::string_view kNameExpected = "printable UTF-8 text of at most 200 bytes";

// The same of the value of an option: "--serial".
[[nodiscard]] Read<void> check_option_text(std::string_view option, std::string_view text);

}  // namespace armsig::tool
