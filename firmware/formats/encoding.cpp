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

}  // namespace

bool is_utf16(std::string_view bytes) {
  return bytes.starts_with(kLittleEndian) || bytes.starts_with(kBigEndian) ||
         order_by_zeros(bytes) != Order::kNone;
}

Utf16Decoder::Utf16Decoder(std::string_view bytes) {
  const bool marked = bytes.starts_with(kLittleEndian) || bytes.starts_with(kBigEndian);
  mark_ = marked ? kLittleEndian.size() : 0;
  little_endian_ =
      marked ? bytes.starts_with(kLittleEndian) : order_by_zeros(bytes) == Order::kLittle;
}

bool Utf16Decoder::append(std::string_view bytes, std::string& text) {
  const std::size_t skipped = std::min(mark_, bytes.size());
  mark_ -= skipped;
  bytes.remove_prefix(skipped);
  for (const char byte : bytes) {
    if (!half_unit_) {
      half_unit_ = byte;
      continue;
    }
    const auto first = static_cast<unsigned char>(*half_unit_);
    const auto second = static_cast<unsigned char>(byte);
    half_unit_.reset();
    const std::uint32_t unit = little_endian_ ? first | static_cast<std::uint32_t>(second) << 8U
                                              : second | static_cast<std::uint32_t>(first) << 8U;
    if (!take(unit, text)) return false;
  }
  return true;
}

bool Utf16Decoder::take(std::uint32_t unit, std::string& text) {
  const bool first_of_pair = unit >= 0xD800 && unit <= 0xDBFF;
  const bool second_of_pair = unit >= 0xDC00 && unit <= 0xDFFF;
  if (second_of_pair != (half_pair_ != 0)) return false;
  if (first_of_pair) {
    half_pair_ = unit;
  } else if (second_of_pair) {
    append_utf8(text, 0x10000U + ((half_pair_ - 0xD800U) << 10U) + (unit - 0xDC00U));
    half_pair_ = 0;
  } else {
    append_utf8(text, unit);
  }
  return true;
}

std::optional<std::string> in_utf8(std::string_view bytes) {
  if (!is_utf16(bytes)) {
    if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
    return std::string(bytes);
  }
  std::string text;
  Utf16Decoder decoder(bytes);
  if (!decoder.append(bytes, text) || !decoder.is_whole()) return std::nullopt;
  return text;
}

bool has_lone_returns(std::string_view bytes) {
  return bytes.find('\r') != std::string_view::npos && bytes.find('\n') == std::string_view::npos;
}

}  // namespace armsig::tool
