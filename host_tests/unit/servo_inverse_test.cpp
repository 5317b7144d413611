// SPDX-License-Identifier: MIT
// Inverse kinematics in the servo tick, with and without joints that turn otherwise than they read.
#include "core/calibration/servo_inverse.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
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

TEST(ServoInverse, keeps_limits_and_steps_by_the_readings) {
  Arm arm = test::puma();
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, {});
  const Pose X_0n = *forward(chain, turned_joints(arm), kHere);
  arm.limits[1].lower = kHere[1] + 1e-5;
  const ServoReadings joints = turned_joints(arm);
  const auto verdict = [&](const ServoReadings& by, const kinematics::InverseOptions& options) {
    const auto found = inverse(chain, by, X_0n, kHere, options);
    EXPECT_TRUE(found);
    return found ? found->verdict : Verdict::kOutOfReach;
  };
  EXPECT_EQ(verdict(joints, {}), Verdict::kJointLimit);
  EXPECT_EQ(verdict(joints, {.respect_limits = false}), Verdict::kConverged);
  arm.limits[1] = {kHere[1] - 1, kHere[1] - 1e-5};
  EXPECT_EQ(verdict(turned_joints(arm), {}), Verdict::kJointLimit);
  arm.limits.clear();
  EXPECT_EQ(verdict(turned_joints(arm), {}), Verdict::kConverged);
}

TEST(ServoInverse, says_of_a_pose_near_a_fold_that_it_is_met_badly) {
  const Arm arm = test::puma();
  const ServoReadings joints = turned_joints(arm);
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, joints.turned_limits());
  JointVector seed = kHere;
  seed[1] += 0.01;
  kinematics::InverseOptions options;
  options.degraded_below = 1e3;
  const auto found = inverse(chain, joints, *forward(chain, joints, kHere), seed, options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, Verdict::kDegraded);
  options.max_step = JointVector(6, 1e-3);
  const auto far = inverse(chain, joints, *forward(chain, joints, kHere), seed, options);
  ASSERT_TRUE(far);
  EXPECT_NE(far->verdict, Verdict::kDegraded) << "and a step is too long however it is met";
}

TEST(ServoInverse, hands_on_what_is_refused) {
  const Arm arm = test::puma();
  const ServoReadings joints = turned_joints(arm);
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, arm.limits);
  JointVector nowhere = kHere;
  nowhere[2] = std::nan("");
  for (const ServoReadings& by : {joints, ServoReadings()}) {
    const auto pose = forward(chain, by, nowhere);
    ASSERT_FALSE(pose);
    EXPECT_EQ(test::failure_of(pose), Error::kNotFinite);
    const auto found = inverse(chain, by, *forward(chain, by, kHere), nowhere, {});
    ASSERT_FALSE(found);
    EXPECT_EQ(test::failure_of(found), Error::kNotFinite);
  }
}

TEST(ServoInverse, is_plain_forward_where_readings_say_everything) {
  const kinematics::Chain chain = kinematics::make_chain(test::puma().joints, {});
  const Pose plain = *kinematics::forward(chain, kHere);
  EXPECT_EQ(forward(chain, ServoReadings(), kHere)->p, plain.p);
  EXPECT_NE(forward(chain, turned_joints(test::puma()), kHere)->p, plain.p);
}

}  // namespace
}  // namespace armsig::calibration
