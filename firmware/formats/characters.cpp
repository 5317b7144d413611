// SPDX-License-Identifier: MIT
#include "firmware/formats/characters.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr bool is_between(std::uint32_t code, std::uint32_t lowest, std::uint32_t highest) {
  return code >= lowest && code <= highest;
}

std::string escape_of(std::uint32_t code) {
  return code < 0x100 ? fmt::format("\\x{:02X}", code) : fmt::format("\\u{:04X}", code);
}

std::string with_escapes(std::string_view text, bool keep_line_feeds) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character character = first_character(text);
    const std::size_t length = std::max<std::size_t>(character.length, 1);
    const bool kept = is_printable(character.code) || (keep_line_feeds && text[0] == '\n');
    if (character.length > 0 && kept) {
      out += text.substr(0, length);
    } else {
      const bool is_byte = character.length == 0;
      out += escape_of(is_byte ? static_cast<std::uint8_t>(text[0]) : character.code);
    }
    text.remove_prefix(length);
  }
  return out;
}

}  // namespace

Character first_character(std::string_view text) {
  if (text.empty()) return {};
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  if (first < 0x80) return {1, first};
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return {};
  std::uint32_t code = first & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) return {};
    code = (code << 6U) | (byte(i) & 0x3FU);
  }
  const bool overlong = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
  const bool surrogate = is_between(code, 0xD800, 0xDFFF);
  if (overlong || surrogate || code > 0x10FFFF) return {};
  return {length, code};
}

bool is_printable(std::uint32_t code) {
  const bool control = code < 0x20 || is_between(code, 0x7F, 0x9F);
  const bool separator = is_between(code, 0x2028, 0x2029);
  const bool turns_direction = is_between(code, 0x202A, 0x202E) || is_between(code, 0x2066, 0x2069);
  const bool byte_order_mark = code == 0xFEFF;
  const bool noncharacter = (code & 0xFFFEU) == 0xFFFEU || is_between(code, 0xFDD0, 0xFDEF);
  return !control && !separator && !turns_direction && !byte_order_mark && !noncharacter;
}

std::optional<std::size_t> first_unprintable(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const Character character = first_character(text.substr(at));
    if (character.length == 0 || !is_printable(character.code)) return at;
    at += character.length;
  }
  return std::nullopt;
}

std::string shown(std::string_view text) { return with_escapes(text, false); }

std::string markup_text(std::string_view text) {
  std::string markup;
  for (const char c : shown(text)) {
    switch (c) {
      case '&':
        markup += "&amp;";
        break;
      case '<':
        markup += "&lt;";
        break;
      case '>':
        markup += "&gt;";
        break;
      case '"':
        markup += "&quot;";
        break;
      default:
        markup += c;
    }
  }
  return markup;
}

std::string shown_lines(std::string_view text) { return with_escapes(text, true); }

std::optional<std::string> why_no_name(std::string_view text) {
  if (text.size() > kLongestName) return fmt::format("{} bytes", text.size());
  const auto bad = first_unprintable(text);
  if (!bad) return std::nullopt;
  const std::size_t length = std::max<std::size_t>(first_character(text.substr(*bad)).length, 1);
  return fmt::format("the character {} in {}", in_quotes(text.substr(*bad, length)),
                     in_quotes(text));
}

Read<void> check_option_text(std::string_view option, std::string_view text) {
  const auto why = why_no_name(text);
  if (!why) return {};
  return std::unexpected(Problem{std::string(option), 0, 0, *why, std::string(kNameExpected)});
}

}  // namespace armsig::tool
