// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/formats/pi_text.hpp"

namespace armsig::tool {
namespace {

TEST(PiText, is_read_as_people_write_it) {
  EXPECT_EQ(parse_pi("pi"), kPi);
  EXPECT_EQ(parse_pi("-PI"), -kPi);
  EXPECT_EQ(parse_pi("pi/2"), kPi / 2);
  EXPECT_EQ(parse_pi("+ pi / 2"), kPi / 2);
  EXPECT_EQ(parse_pi("-3*pi/4"), -3 * kPi / 4);
  EXPECT_EQ(parse_pi("2 pi"), 2 * kPi);
  EXPECT_EQ(parse_pi("0.5\xCF\x80"), kPi / 2);
  EXPECT_EQ(parse_pi("pi*3/2"), kPi * 3 / 2);
  EXPECT_EQ(parse_pi("M_PI/2"), kPi / 2);
}

TEST(PiText, is_nothing_where_it_is_anything_else) {
  for (const char* text : {"", "1.5", "pie", "pi/", "pi/0", "pi2", "x*pi", "pi/2/x", "1e308*pi*10",
                           "*pi", "pi**2", "pi+1", "pipi"}) {
    EXPECT_FALSE(parse_pi(text)) << text;
  }
  EXPECT_FALSE(names_pi("1.5708"));
  EXPECT_TRUE(names_pi("pie"));
}

}  // namespace
}  // namespace armsig::tool
