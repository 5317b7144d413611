// SPDX-License-Identifier: MIT
#include "core/base/error.hpp"

#include <iterator>

#include "core/base/packed_texts.hpp"

namespace armsig {
namespace {

constexpr std::string_view kWords[] = {
#define ARMSIG_ERROR(code, words) std::string_view(words),
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};

constexpr auto kEachCharacter = [](auto begin, auto take) {
  for (std::size_t number = 0; number < std::size(kWords); ++number) {
    begin(number);
    for (const char c : kWords[number]) take(c);
  }
};

constexpr PackedTexts<std::size(kWords), kEachCharacter> kPacked;

}  // namespace

std::string_view describe(Error error) {
  const auto number = static_cast<std::size_t>(error);
  return number < std::size(kWords) ? kPacked[number] : "unknown error";
}

}  // namespace armsig
