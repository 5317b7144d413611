// SPDX-License-Identifier: MIT
#include "core/base/error.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

namespace armsig {
namespace {

constexpr std::string_view kWords[] = {
#define ARMSIG_ERROR(code, words) std::string_view(words),
#include "core/base/error_list.hpp"
#undef ARMSIG_ERROR
};
constexpr std::size_t kCount = std::size(kWords);

consteval std::size_t length_of_all() {
  std::size_t length = 0;
  for (const std::string_view words : kWords) length += words.size();
  return length;
}

// All words without a gap, as those of the names (error_name.hpp): a switch of so many cases takes
// four times the memory in an image.
struct AllWords {
  std::array<char, length_of_all()> characters{};
  std::array<std::uint16_t, kCount + 1> begin{};
};

consteval AllWords all_words() {
  AllWords all;
  std::size_t end = 0;
  for (std::size_t number = 0; number < kCount; ++number) {
    std::ranges::copy(kWords[number], all.characters.begin() + static_cast<std::ptrdiff_t>(end));
    end += kWords[number].size();
    all.begin[number + 1] = static_cast<std::uint16_t>(end);
  }
  return all;
}
static_assert(length_of_all() <= UINT16_MAX);

constexpr AllWords kAllWords = all_words();

}  // namespace

std::string_view describe(Error error) {
  const auto number = static_cast<std::size_t>(error);
  if (number >= kCount) return "unknown error";
  const auto& [characters, begin] = kAllWords;
  return {characters.data() + begin[number],
          static_cast<std::size_t>(begin[number + 1] - begin[number])};
}

}  // namespace armsig
