// SPDX-License-Identifier: MIT
// What a stored signature is told to be of: it must stay the same from one version to the next, or
// no stored signature would be used again.
#include "firmware/controller/machine.hpp"

#include <gtest/gtest.h>

namespace armsig::controller {
namespace {

Arm two_joints() {
  Arm arm;
  arm.joints.push_back(
      {.type = JointType::kPrismatic, .theta_rad = 0.5, .d_m = 1, .a_m = 2, .alpha_rad = 0.25});
  arm.joints.push_back(
      {.type = JointType::kRevolute, .theta_rad = -0.5, .d_m = 0.125, .a_m = 3, .alpha_rad = -1});
  arm.couplings.push_back({.joint = 1, .from = 0, .ratio = 2});
  return arm;
}

// By Python's zlib.crc32 over the little-endian doubles 1, theta, d, a, alpha; 0, ...; joint, from,
// ratio; 0, 0, 1, which is up.
TEST(DrawingCrc, is_that_of_its_numbers_in_their_order) {
  EXPECT_EQ(drawing_crc(two_joints()), 0xA4D52ECDU);
}

TEST(DrawingCrc, differs_in_every_part_of_a_coupling_and_in_how_the_arm_stands) {
  const std::uint32_t as_drawn = drawing_crc(two_joints());
  Arm other = two_joints();
  other.couplings[0].joint = 0;
  EXPECT_NE(drawing_crc(other), as_drawn);
  other = two_joints();
  other.couplings[0].from = 1;
  EXPECT_NE(drawing_crc(other), as_drawn);
  other = two_joints();
  other.couplings[0].ratio = -2;
  EXPECT_NE(drawing_crc(other), as_drawn);
  other = two_joints();
  other.up_0 = {1, 0, 0};
  EXPECT_NE(drawing_crc(other), as_drawn) << "on a wall";
}

// Two axes of a drive have one serial number.
TEST(Machine, differs_in_the_axis_of_a_drive) {
  const hal::DriveIdentity first{.device = {1, 2, 3, 4}};
  hal::DriveIdentity second = first;
  second.axis = 2;
  EXPECT_NE(mark_of(first), mark_of(second));
  const Machine expected{.drives = {first}, .drawing_crc = 0};
  const Machine found{.drives = {second}, .drawing_crc = 0};
  const auto told = difference(expected, found);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->what, "axis");
  EXPECT_EQ(told->found, 2);
  EXPECT_EQ(told->expected, 1);
  EXPECT_FALSE(difference(expected, found, Amplifiers::kIgnored));
}

}  // namespace
}  // namespace armsig::controller
