// SPDX-License-Identifier: MIT
// Text in the encodings that measuring programs write, as UTF-8.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace armsig::tool {

// UTF-16 to UTF-8, piece by piece (RFC 2781: two units of a pair make one character beyond the
// first 65,536).
class Utf16Decoder {
 public:
  // Of a text that begins as `bytes`; a byte order mark is left out of what append() gives.
  // Precondition: is_utf16(bytes).
  explicit Utf16Decoder(std::string_view bytes);

  // Appends the next `bytes` to `text`; a character that they break is completed by the next ones.
  // False where a half of a pair stands alone.
  [[nodiscard]] bool append(std::string_view bytes, std::string& text);
  // Whether no character is broken off.
  [[nodiscard]] bool is_whole() const { return !half_unit_ && half_pair_ == 0; }

 private:
  [[nodiscard]] bool take(std::uint32_t unit, std::string& text);

  bool little_endian_ = true;
  std::size_t mark_ = 0;           // bytes of the mark that are still to come
  std::optional<char> half_unit_;  // the first byte of a unit
  std::uint32_t half_pair_ = 0;    // the first unit of a pair; 0: none
};

// Whether `bytes` begin as text in UTF-16: with its byte order mark, or, where there is none, with
// every other byte zero, as in names and numbers that have one.
[[nodiscard]] bool is_utf16(std::string_view bytes);

// `bytes` as UTF-8 without a byte order mark: of UTF-16 where is_utf16() says so, of UTF-8 as it
// is. Nothing where UTF-16 breaks off in mid-character.
[[nodiscard]] std::optional<std::string> in_utf8(std::string_view bytes);

// Whether the lines of text that begins as `bytes` end in a carriage return alone: it has one, and
// no line feed.
[[nodiscard]] bool has_lone_returns(std::string_view bytes);

}  // namespace armsig::tool
