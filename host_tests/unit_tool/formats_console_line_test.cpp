// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "firmware/formats/console_line.hpp"

namespace armsig::tool {
namespace {

TEST(ConsoleLine, gives_words_and_values_in_their_order) {
  ConsoleLine line("ok  mode=idle says=\"two words\" end");
  EXPECT_EQ(line.next()->value, "ok");
  const auto mode = line.next();
  EXPECT_EQ(mode->key, "mode");
  EXPECT_EQ(mode->value, "idle");
  const auto says = line.next();
  EXPECT_EQ(says->key, "says");
  EXPECT_EQ(says->value, "two words");
  const auto end = line.next();
  EXPECT_EQ(end->key, "");
  EXPECT_EQ(end->value, "end");
  EXPECT_FALSE(line.next());
}

TEST(ConsoleLine, finds_no_key_inside_of_quotes) {
  EXPECT_EQ(value_in("ok says=\"x mode=faulted y\" mode=idle", "mode"), "idle");
  EXPECT_FALSE(value_in("ok says=\"x mode=faulted y\"", "mode"));
}

TEST(ConsoleLine, finds_whole_keys_only) {
  EXPECT_FALSE(value_in("ok fault_joint=3", "joint"));
  EXPECT_FALSE(value_in("ok joint_fault=3", "joint"));
  EXPECT_FALSE(value_in("ok", "ok"));
  EXPECT_FALSE(value_in("ok mode=1", ""));
}

TEST(ConsoleLine, takes_a_value_that_is_empty_or_torn) {
  EXPECT_EQ(value_in("ok hex= part=2", "hex"), "");
  EXPECT_EQ(value_in("ok hex= part=2", "part"), "2");
  EXPECT_EQ(value_in("ok says=\"torn", "says"), "torn");
  EXPECT_EQ(value_in("ok says=", "says"), "");
}

}  // namespace
}  // namespace armsig::tool
