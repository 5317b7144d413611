// SPDX-License-Identifier: MIT
#include "hal/canopen/emergency.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::canopen {
namespace {

TEST(Emergency, decodes_code_register_and_own_bytes) {
  const auto emergency = decode_emergency(test::frame("081#1186210102030405"));
  ASSERT_TRUE(emergency);
  EXPECT_EQ(emergency->code, 0x8611);
  EXPECT_EQ(emergency->error_register, 0x21);
  EXPECT_EQ(emergency->own[4], 5);
}

TEST(Emergency, refuses_another_length) {
  EXPECT_FALSE(decode_emergency(test::frame("081#11862101020304")));
}

TEST(Emergency, words_a_known_code) {
  EXPECT_EQ(describe_emergency(0x0000), "no error");
  EXPECT_EQ(describe_emergency(0x8611), "following error");
  EXPECT_EQ(describe_emergency(0x8130), "the master's heartbeat is lost");
}

TEST(Emergency, words_an_unknown_code_by_its_class) {
  EXPECT_EQ(describe_emergency(0x2345), "current on the output side");
  EXPECT_EQ(describe_emergency(0x4FFF), "temperature");
  EXPECT_EQ(describe_emergency(0xFF12), "device specific error");
}

TEST(Emergency, says_so_where_not_even_the_class_is_known) {
  EXPECT_EQ(describe_emergency(0xA000), "unknown emergency code");
}

}  // namespace
}  // namespace armsig::canopen
