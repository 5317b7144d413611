// SPDX-License-Identifier: MIT
#include "firmware/formats/encoding.hpp"

#include <cstdint>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kLittleEndian = "\xFF\xFE";
constexpr std::string_view kBigEndian = "\xFE\xFF";

void append_utf8(std::string& text, std::uint32_t code) {
  const auto byte = [&](std::uint32_t bits) { text += static_cast<char>(bits); };
  const auto following = [&](unsigned shift) { byte(0x80U | ((code >> shift) & 0x3FU)); };
  if (code < 0x80) {
    byte(code);
  } else if (code < 0x800) {
    byte(0xC0U | (code >> 6U));
    following(0);
  } else if (code < 0x10000) {
    byte(0xE0U | (code >> 12U));
    following(6);
    following(0);
  } else {
    byte(0xF0U | (code >> 18U));
    following(12);
    following(6);
    following(0);
  }
}

// RFC 2781: two units of a pair make one character beyond the first 65,536.
std::optional<std::string> from_utf16(std::string_view bytes, bool little_endian) {
  if (bytes.size() % 2 != 0) return std::nullopt;
  const auto unit = [&](std::size_t at) {
    const auto low = static_cast<unsigned char>(bytes[little_endian ? at : at + 1]);
    const auto high = static_cast<unsigned char>(bytes[little_endian ? at + 1 : at]);
    return static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 8U;
  };
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    const std::uint32_t code = unit(at);
    if (code < 0xD800 || code > 0xDFFF) {
      append_utf8(text, code);
      continue;
    }
    if (code > 0xDBFF || at + 2 >= bytes.size()) return std::nullopt;
    const std::uint32_t second = unit(at + 2);
    if (second < 0xDC00 || second > 0xDFFF) return std::nullopt;
    append_utf8(text, 0x10000U + ((code - 0xD800U) << 10U) + (second - 0xDC00U));
    at += 2;
  }
  return text;
}

}  // namespace

bool is_utf16(std::string_view bytes) {
  return bytes.starts_with(kLittleEndian) || bytes.starts_with(kBigEndian);
}

std::optional<std::string> in_utf8(std::string_view bytes) {
  if (bytes.starts_with(kLittleEndian)) return from_utf16(bytes.substr(2), true);
  if (bytes.starts_with(kBigEndian)) return from_utf16(bytes.substr(2), false);
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return std::string(bytes);
}

}  // namespace armsig::tool
