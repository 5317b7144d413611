// SPDX-License-Identifier: MIT
// The name of an Error for programs: kWrongMode is "WRONG_MODE".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string_view>

#include "core/base/error.hpp"

namespace armsig {
namespace error_name_detail {

// The enumerators as they are written, with their k.
inline constexpr std::string_view kCodes[] = {
#define ARMSIG_ERROR(code, words) #code,
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};
inline constexpr std::size_t kCount = std::size(kCodes);

// take(character) of every name, one after the other; begin(number) before each.
template <typename Begin, typename Take>
constexpr void each_character(Begin begin, Take take) {
  for (std::size_t number = 0; number < kCount; ++number) {
    begin(number);
    bool first = true;
    for (const char c : kCodes[number].substr(1)) {
      if (c >= 'A' && c <= 'Z' && !first) take('_');
      take(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
      first = false;
    }
  }
}

consteval std::size_t length_of_all() {
  std::size_t length = 0;
  each_character([](std::size_t) {}, [&length](char) { ++length; });
  return length;
}

// All names without a gap: an image has no room for as much as the longest takes.
struct Names {
  std::array<char, length_of_all()> characters{};
  std::array<std::uint16_t, kCount + 1> begin{};
};

consteval Names all_names() {
  Names names;
  std::size_t end = 0;
  each_character([&](std::size_t number) { names.begin[number] = static_cast<std::uint16_t>(end); },
                 [&](char c) { names.characters[end++] = c; });
  names.begin[kCount] = static_cast<std::uint16_t>(end);
  return names;
}

inline constexpr Names kNames = all_names();

}  // namespace error_name_detail

[[nodiscard]] constexpr std::string_view name(Error error) {
  const auto number = static_cast<std::size_t>(error);
  if (number >= error_name_detail::kCount) return "ERROR";
  const auto& [characters, begin] = error_name_detail::kNames;
  return {characters.data() + begin[number],
          static_cast<std::size_t>(begin[number + 1] - begin[number])};
}

}  // namespace armsig
