// SPDX-License-Identifier: MIT
// The name of an Error for programs: kWrongMode is "WRONG_MODE".
#pragma once

#include <array>
#include <cstddef>
#include <iterator>
#include <string_view>

#include "core/base/error.hpp"

namespace armsig {
namespace error_name_detail {

struct Name {
  std::array<char, 40> characters{};
  std::size_t size = 0;
};

// Of an enumerator as it is written, with its k.
[[nodiscard]] constexpr Name upper_case(std::string_view code) {
  Name name;
  for (const char c : code.substr(1)) {
    if (c >= 'A' && c <= 'Z' && name.size > 0) name.characters[name.size++] = '_';
    name.characters[name.size++] = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return name;
}

// Of an array of deduced type GCC 12 makes initialised memory, which an image pays for twice.
inline constexpr Name kNames[] = {
#define ARMSIG_ERROR(code, words) upper_case(#code),
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};

}  // namespace error_name_detail

[[nodiscard]] constexpr std::string_view name(Error error) {
  const auto number = static_cast<std::size_t>(error);
  if (number >= std::size(error_name_detail::kNames)) return "ERROR";
  const error_name_detail::Name& name = error_name_detail::kNames[number];
  return {name.characters.data(), name.size};
}

}  // namespace armsig
