// SPDX-License-Identifier: MIT
// The parts of a record from outside.
#include "firmware/controller/receiving.hpp"

#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

constexpr std::size_t kAllParts = (kRecordBytes + kPartBytes - 1) / kPartBytes;

// Part `part` of an image of zeros.
Result<bool> take_part(Receiving& receiving, std::size_t part) {
  const std::size_t bytes = std::min(kPartBytes, kRecordBytes - (part - 1) * kPartBytes);
  const std::string request = "send part=" + std::to_string(part) +
                              " bytes=" + std::to_string(kRecordBytes) +
                              " hex=" + std::string(2 * bytes, '0');
  const auto parsed = parse_request(request);
  EXPECT_TRUE(parsed);
  Line why;
  return receiving.take(*parsed, why);
}

TEST(Receiving, takes_parts_in_their_order_none_after_the_last_and_the_first_at_any_time) {
  Receiving receiving;
  for (std::size_t part = 1; part <= kAllParts; ++part) {
    const auto whole = take_part(receiving, part);
    ASSERT_TRUE(whole) << part;
    EXPECT_EQ(*whole, part == kAllParts) << part;
  }
  EXPECT_EQ(test::failure_of(take_part(receiving, kAllParts)), Error::kOutOfRange);
  ASSERT_TRUE(take_part(receiving, 1));
  EXPECT_EQ(test::failure_of(take_part(receiving, 3)), Error::kOutOfRange);
  EXPECT_TRUE(take_part(receiving, 2));
}

TEST(Receiving, takes_hexadecimal_digits_and_nothing_beside_them) {
  const auto take_begin = [](const std::string& digits) {
    const std::string request = "send part=1 bytes=" + std::to_string(kRecordBytes) +
                                " hex=" + digits + std::string(2 * kPartBytes - 2, '0');
    const auto parsed = parse_request(request);
    EXPECT_TRUE(parsed) << digits;
    Line why;
    return Receiving().take(*parsed, why);
  };
  for (const char* digits : {"09", "90", "af", "fa"}) EXPECT_TRUE(take_begin(digits)) << digits;
  for (const char* digits : {"/0", "0/", ":0", "0:", "`0", "0`", "g0", "0g", "A0", "0F"}) {
    const auto taken = take_begin(digits);
    ASSERT_FALSE(taken) << digits;
    EXPECT_EQ(test::failure_of(taken), Error::kUnknownRequest) << digits;
  }
}

}  // namespace
}  // namespace armsig::controller
