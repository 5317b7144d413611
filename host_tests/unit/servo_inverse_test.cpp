// SPDX-License-Identifier: MIT
// Inverse kinematics in the servo tick, with and without joints that turn otherwise than they read.
#include "core/calibration/servo_inverse.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using kinematics::Verdict;

const JointVector kHere{0.3, -1, 1, 0.2, 0.8, 0.1};

// Every joint turns up to 1 mrad more than it reads.
ServoReadings turned_joints(const Arm& arm) {
  ArmModel model = model_of(arm, {});
  for (JointModel& joint : model.joints) {
    for (std::size_t k = 0; k < kKnots; ++k) {
      const double turn = 2 * kPi * static_cast<double>(k) / kKnots;
      joint.map[k] = 1e-3 / map_unit(joint.type) * std::sin(turn);
    }
  }
  return {packed(model), arm, JointVector(6, 0.0)};
}

// What is left over from joints that turned otherwise is not for those that turn as they read.
TEST(ServoInverse, is_the_plain_one_where_readings_say_everything) {
  const Arm arm = test::puma();
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
  const Pose X_0n = *kinematics::forward(chain, kHere);
  JointVector seed = kHere;
  seed[1] += 0.01;
  LatelyTurned lately;
  lately.by.fill(0.2);
  const auto plain = kinematics::inverse(chain, X_0n, seed, {});
  const auto found = inverse(chain, ServoReadings(), X_0n, seed, {}, lately);
  ASSERT_TRUE(plain);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->iterations, plain->iterations);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(found->q[i], plain->q[i]) << i;
}

TEST(ServoInverse, begins_where_the_tick_before_has_ended) {
  const Arm arm = test::puma();
  const ServoReadings joints = turned_joints(arm);
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, joints.turned_limits());
  const Pose X_0n = *forward(chain, joints, kHere);
  JointVector seed = kHere;
  for (double& reading : seed) reading += 0.01;
  LatelyTurned lately;
  const auto first = inverse(chain, joints, X_0n, seed, {}, lately);
  ASSERT_TRUE(first);
  ASSERT_EQ(first->verdict, Verdict::kConverged);
  EXPECT_GT(first->iterations, 0);
  const auto again = inverse(chain, joints, X_0n, first->q, {}, lately);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->verdict, Verdict::kConverged);
  LatelyTurned nothing;
  const auto anew = inverse(chain, joints, X_0n, first->q, {}, nothing);
  ASSERT_TRUE(anew);
  EXPECT_LT(again->iterations, anew->iterations);
}

}  // namespace
}  // namespace armsig::calibration
