// SPDX-License-Identifier: MIT
// Small pieces of the messages and of the files: quoting, lists, near misses, numbers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace armsig::tool {

// What some editors begin a file of UTF-8 with.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

// `text` in double quotes, clipped to 40 bytes, what is not printable escaped (characters.hpp).
[[nodiscard]] std::string in_quotes(std::string_view text);

// "a", "a or b", "a, b or c".
[[nodiscard]] std::string any_of(std::span<const std::string> words);

// "a", "a and b", "a, b and c".
[[nodiscard]] std::string all_of(std::span<const std::string> words);

// The candidate that `word` most likely meant to be: at most a third of its letters (at least 1)
// inserted, deleted or replaced. Empty if there is none.
[[nodiscard]] std::string nearest(std::string_view word, std::span<const std::string> candidates);

// `text` without spaces and tabs at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

// The number that the whole of `text` spells in the C locale, with an optional sign, or nothing:
// not a number, not finite, or beyond the range of a double.
[[nodiscard]] std::optional<double> parse_number(std::string_view text);

// Why parse_number refused `text`: `"1O" is not a number`, `"nan" is not a finite number`, ...
[[nodiscard]] std::string why_not_a_number(std::string_view text);

// The integer that the whole of `text` spells, or nothing.
[[nodiscard]] std::optional<int> parse_integer(std::string_view text);

// The shortest text that parse_number reads back as `value`, bit for bit.
[[nodiscard]] std::string number_text(double value);

// Is `text` printable (characters.hpp) but for tabs, line feeds and carriage returns? Gives the
// position of the first byte that is not, or nothing.
[[nodiscard]] std::optional<std::size_t> first_bad_byte(std::string_view text);

}  // namespace armsig::tool
