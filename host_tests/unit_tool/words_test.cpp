// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/words.hpp"

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

TEST(Words, count_one_thing_as_one) {
  EXPECT_EQ(counted(0, "pose"), "0 poses");
  EXPECT_EQ(counted(1, "pose"), "1 pose");
  EXPECT_EQ(counted(2, "pose"), "2 poses");
}

TEST(Words, give_a_duration_in_the_units_that_a_person_plans_by) {
  EXPECT_EQ(duration_in_words(8.4), "8 s");
  EXPECT_EQ(duration_in_words(725), "12 min 5 s");
  EXPECT_EQ(duration_in_words(12000), "3 h 20 min");
}

}  // namespace
}  // namespace armsig::tool
