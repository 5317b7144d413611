// SPDX-License-Identifier: MIT
#include "firmware/formats/encoding.hpp"

#include <algorithm>
#include <cstdint>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::string_view kLittleEndian = "\xFF\xFE";
constexpr std::string_view kBigEndian = "\xFE\xFF";

// Text without a mark is judged by its beginning: letters, digits and signs of ASCII but for a few.
constexpr std::size_t kJudged = 1024;  // bytes
constexpr double kMostlyAscii = 0.7;

enum class Order : std::uint8_t { kNone, kLittle, kBig };

Order order_by_zeros(std::string_view bytes) {
  const std::size_t units = std::min(bytes.size(), kJudged) / 2;
  std::size_t first = 0;
  std::size_t second = 0;
  for (std::size_t k = 0; k < units; ++k) {
    first += bytes[2 * k] == '\0' ? 1 : 0;
    second += bytes[2 * k + 1] == '\0' ? 1 : 0;
  }
  const double enough = kMostlyAscii * static_cast<double>(units);
  if (units == 0 || (first > 0 && second > 0)) return Order::kNone;
  if (static_cast<double>(second) >= enough) return Order::kLittle;
  return static_cast<double>(first) >= enough ? Order::kBig : Order::kNone;
}

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
  return bytes.starts_with(kLittleEndian) || bytes.starts_with(kBigEndian) ||
         order_by_zeros(bytes) != Order::kNone;
}

std::optional<std::string> in_utf8(std::string_view bytes) {
  if (bytes.starts_with(kLittleEndian)) return from_utf16(bytes.substr(2), true);
  if (bytes.starts_with(kBigEndian)) return from_utf16(bytes.substr(2), false);
  if (const Order order = order_by_zeros(bytes); order != Order::kNone) {
    return from_utf16(bytes, order == Order::kLittle);
  }
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return std::string(bytes);
}

bool has_lone_returns(std::string_view bytes) {
  return bytes.find('\r') != std::string_view::npos && bytes.find('\n') == std::string_view::npos;
}

}  // namespace armsig::tool
