// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/placement.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::simulated {
namespace {

using Receivers = FixedVector<Vector3, kMaxReceivers>;

SimulatedArm placed(const Arm& arm, const Receivers& receivers_S, const Vector3& facing_S) {
  SimulatedArm world{.arm = arm, .X_S0 = {}, .targets = {}};
  world.targets.push_back({.number = 1, .link = arm.joints.size(), .p_L = {0.15, 0, 0.05}});
  world.X_S0 = base_pose(world, {receivers_S.data(), receivers_S.size()}, facing_S);
  return world;
}

SimulatedArm under_the_demo_sensor(const Arm& arm) {
  return placed(arm, demo_sensor().receivers_S, demo_sensor_facing());
}

// Of the target, at readings by another seed than the placement's.
double nearest_along(const SimulatedArm& world, const Vector3& direction) {
  Random random(7);
  double nearest = 1e9;
  for (int drawn = 0; drawn < 5000; ++drawn) {
    JointVector q;
    for (const JointLimits& range : world.arm.limits) {
      q.push_back(random.uniform(range.lower, range.upper));
    }
    nearest = std::min(nearest, target_position(world, q, world.targets[0]).dot(direction));
  }
  return nearest;
}

Arm scaled(Arm arm, double by) {
  for (DhJoint& row : arm.joints) {
    row.a_m *= by;
    row.d_m *= by;
  }
  return arm;
}

// A Puma 560 on a rail of that length, whose axis is horizontal.
Arm on_a_rail(double length_m) {
  const Arm carried = tool::puma560();
  Arm arm;
  arm.joints.push_back({.type = JointType::kPrismatic, .alpha_rad = -kPi / 2});
  arm.limits.push_back({0, length_m});
  for (const DhJoint& row : carried.joints) arm.joints.push_back(row);
  for (const JointLimits& range : carried.limits) arm.limits.push_back(range);
  arm.up_0 = -Vector3::UnitY();
  return arm;
}

TEST(BasePose, of_the_arm_of_the_demonstration_is_the_one_of_the_demonstration) {
  const SimulatedArm world = under_the_demo_sensor(tool::puma560());
  EXPECT_EQ(world.X_S0.p, demo_base_pose().p);
  EXPECT_EQ(world.X_S0.R, demo_base_pose().R);
}

TEST(BasePose, keeps_the_target_of_small_and_large_arms_clear_of_the_receivers) {
  for (const double by : {0.3, 1.0, 3.3, 6.0}) {
    const SimulatedArm world = under_the_demo_sensor(scaled(tool::puma560(), by));
    const double clear_m = nearest_along(world, demo_sensor_facing());
    EXPECT_GT(clear_m, 0.05) << by;
    EXPECT_LT(clear_m, 0.3 + 0.1 * by) << by;
  }
}

TEST(BasePose, suits_every_known_arm_on_the_floor_on_a_wall_and_at_the_ceiling) {
  for (const test::KnownArm& known : test::known_arms()) {
    Arm arm = known.drawing;
    for (const Vector3& up_0 : {Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 0, -1)}) {
      arm.up_0 = up_0;
      EXPECT_GT(nearest_along(under_the_demo_sensor(arm), demo_sensor_facing()), 0.05)
          << known.name << " " << up_0.transpose();
    }
  }
}

TEST(BasePose, has_the_sensor_above_an_arm_on_a_wall_and_below_one_at_the_ceiling) {
  Arm arm = tool::puma560();
  arm.up_0 = Vector3::UnitX();
  EXPECT_GT((under_the_demo_sensor(arm).X_S0.R * arm.up_0).z(), 0.99);
  arm.up_0 = -Vector3::UnitZ();
  EXPECT_LT((under_the_demo_sensor(arm).X_S0.R * arm.up_0).z(), -0.99);
}

TEST(BasePose, of_a_rail_has_its_middle_below_the_receivers) {
  const SimulatedArm world = under_the_demo_sensor(on_a_rail(6));
  const JointVector middle{3, 0, radians(-90), radians(90), 0, 0, 0};
  const Vector3 carriage_S = link_pose(world, middle, 1).p;
  EXPECT_LT(carriage_S.head<2>().norm(), 0.5);
  EXPECT_GT(nearest_along(world, demo_sensor_facing()), 0.05);
}

TEST(BasePose, is_on_the_side_that_the_receivers_face) {
  for (const Vector3& facing : {Vector3(0, 0, 2), Vector3(1, 0, 0), Vector3(0, -1, 0)}) {
    const SimulatedArm world = placed(tool::puma560(), demo_sensor().receivers_S, facing);
    double farthest = -1e9;
    for (const Vector3& p_S : demo_sensor().receivers_S) {
      farthest = std::max(farthest, p_S.dot(facing.normalized()));
    }
    EXPECT_GT(nearest_along(world, facing.normalized()), farthest + 0.05) << facing.transpose();
  }
}

TEST(BasePose, without_receivers_is_the_one_of_the_demonstration) {
  EXPECT_EQ(placed(on_a_rail(6), {}, Vector3::Zero()).X_S0.p, demo_base_pose().p);
}

}  // namespace
}  // namespace armsig::simulated
