// SPDX-License-Identifier: MIT
// The name of an Error for programs, as its enumerator spells it: kWrongMode is "WRONG_MODE".
#pragma once

#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

#include "core/base/error.hpp"

namespace armsig {
namespace error_name_detail {

inline constexpr std::size_t kLongest = 40;

struct Name {
  std::array<char, kLongest> characters{};
  std::size_t size = 0;
};

// The compiler's own spelling of a template argument, so that names and enumerators cannot drift
// apart: "... [with Error kError = armsig::Error::kWrongMode]"; of a value without enumerator it is
// a number.
template <Error kError>
[[nodiscard]] constexpr std::string_view spelt() {
  std::string_view text = __PRETTY_FUNCTION__;
  const std::size_t begin = text.rfind("::k");
  text.remove_prefix(begin == std::string_view::npos ? text.size() : begin + 3);
  std::size_t length = 0;
  while (length < text.size() && text[length] != ']' && text[length] != ';') ++length;
  return text.substr(0, length);
}

constexpr bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

template <Error kError>
[[nodiscard]] constexpr Name upper_case() {
  Name name;
  for (const char c : spelt<kError>()) {
    if (is_capital(c) && name.size > 0) name.characters[name.size++] = '_';
    name.characters[name.size++] = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
  return name;
}

inline constexpr std::size_t kMost = 128;

template <std::size_t... kNumber>
[[nodiscard]] constexpr std::array<Name, kMost> all(std::index_sequence<kNumber...> /*numbers*/) {
  return {upper_case<static_cast<Error>(kNumber)>()...};
}

inline constexpr std::array<Name, kMost> kNames = all(std::make_index_sequence<kMost>());
static_assert(kNames[static_cast<std::size_t>(Error::kNotFinite)].size == 10);
static_assert(kNames[static_cast<std::size_t>(Error::kRecordUnsuitable)].size == 17);

}  // namespace error_name_detail

[[nodiscard]] constexpr std::string_view name(Error error) {
  const auto number = static_cast<std::size_t>(error);
  if (number >= error_name_detail::kMost) return "ERROR";
  const error_name_detail::Name& name = error_name_detail::kNames[number];
  return {name.characters.data(), name.size};
}

}  // namespace armsig
