// SPDX-License-Identifier: MIT
// What a refinement says of joints, in words.
#include "firmware/host_tool/refinement/refinement_words.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr const char* kOfOne =
    " stood still: nothing measured tells its parameters, which stay nominal; the predicted tool "
    "error is for all readings of it";
constexpr const char* kOfMore =
    " stood still: nothing measured tells their parameters, which stay nominal; the predicted tool "
    "error is for all readings of them";

std::string words(const std::vector<std::size_t>& joints) { return still_in_words(joints); }

TEST(StillInWords, names_one_joint_two_and_ranges_of_three_or_more) {
  EXPECT_EQ(words({5}), std::string("joint 6") + kOfOne);
  EXPECT_EQ(words({0, 1}), std::string("joints 1 and 2") + kOfMore);
  EXPECT_EQ(words({0, 2, 4}), std::string("joints 1, 3 and 5") + kOfMore);
  EXPECT_EQ(words({2, 3, 4, 5, 6}), std::string("joints 3 to 7") + kOfMore);
  EXPECT_EQ(words({0, 3, 4, 5}), std::string("joints 1 and 4 to 6") + kOfMore);
  EXPECT_EQ(words({0, 1, 2, 6}), std::string("joints 1 to 3 and 7") + kOfMore);
  EXPECT_EQ(words({0, 2, 3, 6, 7}), std::string("joints 1, 3, 4, 7 and 8") + kOfMore);
}

}  // namespace
}  // namespace armsig::tool
