// SPDX-License-Identifier: MIT
// The kinematics module about individuals of fewer than six joints: they are put where they are
// asked to be, and it says by how much they are turned away.
#include <gtest/gtest.h>

#include "firmware/linuxcnc/kins.hpp"
#include "firmware/linuxcnc/roll_pitch_yaw.hpp"
#include "host_tests/support/short_arms.hpp"

namespace armsig::linuxcnc {
namespace {

using test::ShortArm;

Matrix3 rotation_in(const WorldPose& world) {
  return rotation_of(
      {radians(world.abc_deg.x()), radians(world.abc_deg.y()), radians(world.abc_deg.z())});
}

void expect_line(const ShortArm& arm, const test::KnownArm& built) {
  KinsModel model;
  model.arm.joints = built.joints;
  model.arm.limits = arm.arm.limits;
  const Kins kins(model, arm.p_nT);
  std::vector<double> joints;
  for (std::size_t i = 0; i < arm.at.size(); ++i) {
    const bool turns = built.joints[i].type == JointType::kRevolute;
    joints.push_back(turns ? degrees(arm.at[i]) : 1e3 * arm.at[i]);
  }
  WorldPose world;
  ASSERT_TRUE(kins.forward(joints, world));
  const Vector3 from_mm = world.p_mm;
  for (int k = 1; k <= 100; ++k) {
    world.p_mm = from_mm + 10.0 * k * arm.way;
    const KinsAnswer answer = kins.inverse(world, joints);
    ASSERT_EQ(answer.refusal, "") << built.name << " " << k;
    WorldPose reached;
    ASSERT_TRUE(kins.forward(joints, reached));
    EXPECT_LT((reached.p_mm - world.p_mm).norm(), 1e-6) << built.name;
    EXPECT_NEAR(answer.missed_rad, angle_between(rotation_in(world), rotation_in(reached)), 1e-8)
        << built.name;
  }
}

TEST(LinuxCncShortArms, are_put_in_place_and_say_by_how_much_they_are_turned_away) {
  std::mt19937_64 random(12);
  for (const ShortArm& arm : test::short_arms()) {
    expect_line(arm, arm.arm);
    for (int k = 0; k < 8; ++k) expect_line(arm, test::individual(arm.arm, random));
  }
}

}  // namespace
}  // namespace armsig::linuxcnc
