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

TEST(Crc32, continues_over_pieces) {
  EXPECT_EQ(crc_of("56789", crc_of("1234")), crc_of("123456789"));
}

TEST(Crc32, is_known_at_compile_time) {
  constexpr std::array<std::byte, 1> kZero{};
  static_assert(crc32(kZero) == 0xD202EF8DU);
}

}  // namespace
}  // namespace armsig
