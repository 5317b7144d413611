// SPDX-License-Identifier: MIT
#include "core/base/crc32.hpp"

#include <span>
#include <string_view>

#include <gtest/gtest.h>

namespace armsig {
namespace {

std::uint32_t crc_of(std::string_view text, std::uint32_t before = 0) {
  return crc32(std::as_bytes(std::span(text)), before);
}

TEST(Crc32, gives_the_check_value_of_the_standard) { EXPECT_EQ(crc_of("123456789"), 0xCBF43926U); }

TEST(Crc32, of_nothing_is_zero) { EXPECT_EQ(crc_of(""), 0U); }

// zlib.crc32(b"armsig"), by Python.
TEST(Crc32, agrees_with_zlib) { EXPECT_EQ(crc_of("armsig"), 0x096A1331U); }

// zlib's again; pieces of every length before and after it.
TEST(Crc32, continues_over_pieces) {
  constexpr std::string_view kText = "The quick brown fox jumps over the lazy dog, at 0.05 mm.";
  for (std::size_t i = 0; i <= kText.size(); ++i) {
    EXPECT_EQ(crc_of(kText.substr(i), crc_of(kText.substr(0, i))), 0xF2884FDAU) << i;
  }
}

TEST(Crc32, is_known_at_compile_time) {
  constexpr std::array<std::byte, 1> kZero{};
  static_assert(crc32(kZero) == 0xD202EF8DU);
}

}  // namespace
}  // namespace armsig
