// SPDX-License-Identifier: MIT
#include <array>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

const std::array<std::string, 4> kKnown{"move", "stop", "identify", "q1_deg"};

TEST(Nearest, takes_two_letters_exchanged_for_one_mistake) {
  EXPECT_EQ(nearest("mvoe", kKnown), "move");
  EXPECT_EQ(nearest("stpo", kKnown), "stop");
  EXPECT_EQ(nearest("1q_deg", kKnown), "q1_deg");
}

TEST(Nearest, takes_a_letter_too_many_too_few_or_another) {
  EXPECT_EQ(nearest("sttop", kKnown), "stop");
  EXPECT_EQ(nearest("sop", kKnown), "stop");
  EXPECT_EQ(nearest("atop", kKnown), "stop");
  EXPECT_EQ(nearest("indetify", kKnown), "identify");
}

TEST(Nearest, names_nothing_that_is_far) {
  EXPECT_EQ(nearest("", kKnown), "");
  EXPECT_EQ(nearest("frob", kKnown), "");
  EXPECT_EQ(nearest("spammer", kKnown), "");
  EXPECT_EQ(nearest(std::string(41, 'm'), kKnown), "");
}

}  // namespace
}  // namespace armsig::tool
