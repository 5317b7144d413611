// SPDX-License-Identifier: MIT
// The name of an Error for programs: kWrongMode is "WRONG_MODE".
#pragma once

#include <cstddef>
#include <iterator>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/packed_texts.hpp"

namespace armsig {
namespace error_name_detail {

// The enumerators as they are written, with their k.
inline constexpr std::string_view kCodes[] = {
#define ARMSIG_ERROR(code, words) #code,
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};
inline constexpr std::size_t kCount = std::size(kCodes);

// The names, in capitals.
inline constexpr auto kEachCharacter = [](auto begin, auto take) {
  for (std::size_t number = 0; number < kCount; ++number) {
    begin(number);
    bool first = true;
    for (const char c : kCodes[number].substr(1)) {
      if (c >= 'A' && c <= 'Z' && !first) take('_');
      take(c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c);
      first = false;
    }
  }
};

inline constexpr PackedTexts<kCount, kEachCharacter> kNames;

}  // namespace error_name_detail

[[nodiscard]] constexpr std::string_view name(Error error) {
  const auto number = static_cast<std::size_t>(error);
  return number < error_name_detail::kCount ? error_name_detail::kNames[number] : "ERROR";
}

}  // namespace armsig
