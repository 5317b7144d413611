// SPDX-License-Identifier: MIT
// The line in which an instrument tells lengths: what is taken, and what is refused by which words.
#include "hal/linux/length_line.hpp"

#include <string>

#include <gtest/gtest.h>

namespace armsig::linux_hal {
namespace {

std::string refusal(std::string_view line) {
  const auto lengths = LengthLine::parse(line);
  if (lengths) return "taken";
  return std::string(lengths.error().key) + " " + std::string(lengths.error().what);
}

TEST(LengthLine, tells_lengths_in_millimetres_and_their_number) {
  const auto line = LengthLine::parse("lengths l2_mm=1031.5 seq=17 l1_mm=812.25 l3_mm=9.55e2");
  ASSERT_TRUE(line);
  ASSERT_EQ(line->lengths_m.size(), 3U);
  EXPECT_DOUBLE_EQ(line->lengths_m[0].value_or(0), 0.81225);
  EXPECT_DOUBLE_EQ(line->lengths_m[1].value_or(0), 1.0315);
  EXPECT_DOUBLE_EQ(line->lengths_m[2].value_or(0), 0.955);
  EXPECT_EQ(line->sequence, 17U);
}

TEST(LengthLine, leaves_a_place_for_a_length_that_is_not_read) {
  const auto line = LengthLine::parse("lengths l2_mm=1 l8_mm=3");
  ASSERT_TRUE(line);
  ASSERT_EQ(line->lengths_m.size(), 8U);
  EXPECT_FALSE(line->lengths_m[0]);
  EXPECT_TRUE(line->lengths_m[1]);
  EXPECT_FALSE(line->lengths_m[6]);
  EXPECT_FALSE(line->sequence);
}

TEST(LengthLine, that_is_none_is_refused_by_what_is_wrong) {
  EXPECT_EQ(refusal(""), "the line does not begin with lengths");
  EXPECT_EQ(refusal("length l1_mm=1"), "the line does not begin with lengths");
  EXPECT_EQ(refusal("lengths"), "the line has no length");
  EXPECT_EQ(refusal("lengths seq=1"), "the line has no length");
  EXPECT_EQ(refusal("lengths l0_mm=1"), "a key is unknown");
  EXPECT_EQ(refusal("lengths l9_mm=1"), "a key is unknown");
  EXPECT_EQ(refusal("lengths l1_m=1"), "a key is unknown");
  EXPECT_EQ(refusal("lengths l1_mm=1 l1_mm=1"), "l1_mm is there twice");
  EXPECT_EQ(refusal("lengths l1_mm=1 l2_mm=one"), "l2_mm is not a number");
  EXPECT_EQ(refusal("lengths l1_mm=nan"), "l1_mm is not a number");
  EXPECT_EQ(refusal("lengths l1_mm=1 seq=-1"), "seq is not a whole number of 32 bits");
  for (const char* length : {"0", "-1", "100001"}) {
    EXPECT_EQ(refusal("lengths l3_mm=" + std::string(length)), "l3_mm is not between 0 and 100 m");
  }
}

}  // namespace
}  // namespace armsig::linux_hal
