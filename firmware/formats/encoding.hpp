// SPDX-License-Identifier: MIT
// Text in the encodings that measuring programs write, as UTF-8.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace armsig::tool {

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
