// SPDX-License-Identifier: MIT
// A table of texts without a gap, made by the compiler: an image has no room for as much as the
// longest takes, nor for the cases of a switch.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace armsig {

// `kEach(begin, take)` calls begin(number) before each of the `kCount` texts, by rising numbers,
// and take(character) for every character of it.
template <std::size_t kCount, auto kEach>
class PackedTexts {
 public:
  consteval PackedTexts() {
    std::size_t end = 0;
    kEach([&](std::size_t number) { begin_[number] = static_cast<std::uint16_t>(end); },
          [&](char c) { characters_[end++] = c; });
    begin_[kCount] = static_cast<std::uint16_t>(end);
  }

  // Precondition: number < kCount.
  [[nodiscard]] constexpr std::string_view operator[](std::size_t number) const {
    return {characters_.data() + begin_[number],
            static_cast<std::size_t>(begin_[number + 1] - begin_[number])};
  }

 private:
  static consteval std::size_t length() {
    std::size_t length = 0;
    kEach([](std::size_t) {}, [&](char) { ++length; });
    return length;
  }
  static_assert(length() <= UINT16_MAX);

  std::array<char, length()> characters_{};
  std::array<std::uint16_t, kCount + 1> begin_{};
};

}  // namespace armsig
