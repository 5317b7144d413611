// SPDX-License-Identifier: MIT
// Plans of moves: how long they take and why, which joint they are refused for, and where the arm
// is on the way. Durations are worked out by hand from the limits: 1 rad/s and 3 rad/s2 of every
// joint, 0.25 m/s and 1 rad/s of the tool.
#include "firmware/controller/motion.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using test::kNan;
// A minimum-jerk course has these at its steepest and at its most bent.
const double kSteepest = 30.0 / 16.0;
const double kMostBent = 10.0 / std::sqrt(3.0);

struct Arm6 {
  Configuration configuration = test::puma_controller();
  Model model = model_of(configuration.drawing);
  JointVector from{radians(0), radians(-90), radians(10), radians(30), radians(40), radians(0)};

  [[nodiscard]] JointVector moved(std::size_t joint, double way) const {
    JointVector to = from;
    to[joint] += way;
    return to;
  }
};

TEST(JointMove, lasts_as_long_as_the_joint_needs_that_needs_longest) {
  const Arm6 arm;
  for (std::size_t joint = 0; joint < 6; ++joint) {
    for (const double way : {1.2, -1.2}) {
      const auto [lower, upper] = arm.configuration.drawing.limits[joint];
      if (arm.from[joint] + way < lower || arm.from[joint] + way > upper) continue;
      const Planned slow = plan_joint_move(arm.configuration, arm.from, arm.moved(joint, way));
      ASSERT_TRUE(slow) << joint;
      EXPECT_NEAR(slow->duration_s, kSteepest * 1.2 / 1.0, 1e-9) << "by its speed";
    }
    const Planned sharp = plan_joint_move(arm.configuration, arm.from, arm.moved(joint, 0.1));
    ASSERT_TRUE(sharp);
    EXPECT_NEAR(sharp->duration_s, std::sqrt(kMostBent * 0.1 / 3.0), 1e-9) << "by acceleration";
  }
  JointVector both = arm.moved(0, 1.0);
  both[5] += 1.5;
  EXPECT_NEAR(plan_joint_move(arm.configuration, arm.from, both)->duration_s, kSteepest * 1.5,
              1e-9);
}

TEST(JointMove, is_as_slow_as_its_pace_and_never_shorter_than_a_fiftieth_of_a_second) {
  const Arm6 arm;
  const double whole = plan_joint_move(arm.configuration, arm.from, arm.moved(0, 1.2))->duration_s;
  EXPECT_NEAR(plan_joint_move(arm.configuration, arm.from, arm.moved(0, 1.2), 0.25)->duration_s,
              4 * whole, 1e-12);
  EXPECT_EQ(plan_joint_move(arm.configuration, arm.from, arm.from)->duration_s, 0.02);
  for (const double pace : {0.0, -0.5, 1.0 + 1e-9, kNan}) {
    const auto refusal =
        test::failure_of(plan_joint_move(arm.configuration, arm.from, arm.from, pace));
    EXPECT_EQ(refusal.error, Error::kOutOfRange) << pace;
    EXPECT_FALSE(refusal.joint);
  }
}

TEST(JointMove, may_end_at_a_limit_and_is_refused_beyond_it_for_its_joint) {
  const Arm6 arm;
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const auto [lower, upper] = arm.configuration.drawing.limits[joint];
    for (const double limit : {lower, upper}) {
      JointVector to = arm.from;
      to[joint] = limit;
      EXPECT_TRUE(plan_joint_move(arm.configuration, arm.from, to));
      to[joint] += limit == lower ? -1e-9 : 1e-9;
      const auto refusal = test::failure_of(plan_joint_move(arm.configuration, arm.from, to));
      EXPECT_EQ(refusal.error, Error::kJointLimit);
      EXPECT_EQ(refusal.joint, joint);
    }
  }
}

TEST(JointMove, is_refused_with_other_joints_than_the_arm_has_and_without_a_number) {
  const Arm6 arm;
  JointVector five = arm.from;
  five.resize(5);
  EXPECT_EQ(test::failure_of(plan_joint_move(arm.configuration, arm.from, five)).error,
            Error::kOutOfRange);
  EXPECT_EQ(
      test::failure_of(plan_joint_move(arm.configuration, arm.from, arm.moved(5, kNan))).error,
      Error::kNotFinite);
}

// Motor 6 turns half as far again against joint 5: readings(6) = q6 - 0.5 q5 or with the other
// sign; either way it is the motor that has further to go.
TEST(JointMove, of_a_coupled_joint_keeps_the_limits_of_the_motor_too) {
  Arm6 arm;
  arm.configuration.drawing.couplings.push_back({.joint = 5, .from = 4, .ratio = 2});
  EXPECT_NEAR(plan_joint_move(arm.configuration, arm.from, arm.moved(4, 0.9))->duration_s,
              kSteepest * 1.8, 1e-9);
}

// The reading of the joint is its motor's and what joint 5 adds: each has its own way to go.
TEST(JointMove, of_a_coupled_joint_ends_at_the_limits_of_the_joint_as_well) {
  Arm6 arm;
  arm.configuration.drawing.couplings.push_back({.joint = 5, .from = 4, .ratio = 1});
  const auto [lower, upper] = arm.configuration.drawing.limits[5];
  for (const auto& [beyond, wrist] : {std::pair(upper + 0.2, 0.5), std::pair(lower - 0.2, -0.5)}) {
    JointVector to = arm.from;
    to[4] = wrist;
    to[5] = beyond;
    const auto refusal = test::failure_of(plan_joint_move(arm.configuration, arm.from, to));
    EXPECT_EQ(refusal.error, Error::kJointLimit);
    EXPECT_EQ(refusal.joint, 5U);
  }
}

TEST(Line, lasts_as_long_as_the_tools_own_limits_ask_where_the_joints_ask_less) {
  Arm6 arm;
  for (double& speed : arm.configuration.limits.speed) speed = 30;
  for (double& acceleration : arm.configuration.limits.acceleration) acceleration = 3000;
  Pose to = *tool_pose(arm.model, arm.from);
  to.p.z() -= 0.1;
  EXPECT_NEAR(plan_line(arm.configuration, arm.model, arm.from, to)->duration_s,
              1.05 * kSteepest * 0.1 / 0.25, 1e-9);
  EXPECT_NEAR(plan_line(arm.configuration, arm.model, arm.from, to, 0.5)->duration_s,
              2 * 1.05 * kSteepest * 0.1 / 0.25, 1e-9);
  to = *tool_pose(arm.model, arm.from);
  to.R = to.R * rotation_about(Vector3::UnitX(), 0.2);
  EXPECT_NEAR(plan_line(arm.configuration, arm.model, arm.from, to)->duration_s,
              1.05 * kSteepest * 0.2 / 1.0, 1e-9);
}

// No joint of the plan is faster than its limit, or sharper than it by more than the samples miss,
// and the slowest one comes near.
TEST(Line, keeps_the_limits_of_every_joint_and_wastes_little) {
  Arm6 arm;
  arm.configuration.limits.tool_speed = 20;
  arm.configuration.limits.tool_turn_rate = 40;
  Pose to = *tool_pose(arm.model, arm.from);
  to.p += Vector3(0.1, 0.15, -0.2);
  const Planned line = plan_line(arm.configuration, arm.model, arm.from, to);
  ASSERT_TRUE(line);
  const int steps = static_cast<int>(line->duration_s / 0.002);
  JointVector before = arm.from;
  JointVector speed_before;
  speed_before.resize(6);
  calibration::LatelyTurned lately;
  double fastest = 0;
  double sharpest = 0;
  for (int k = 1; k <= steps; ++k) {
    const double s = minimum_jerk(k * 0.002 / line->duration_s);
    const auto q = readings_at(*line, arm.configuration, arm.model, before, s, lately);
    ASSERT_TRUE(q) << k;
    for (std::size_t i = 0; i < 6; ++i) {
      const double speed = ((*q)[i] - before[i]) / 0.002;
      fastest = std::max(fastest, std::abs(speed));
      sharpest = std::max(sharpest, std::abs(speed - speed_before[i]) / 0.002);
      speed_before[i] = speed;
    }
    before = *q;
  }
  EXPECT_LE(fastest, 1.0);
  EXPECT_LE(sharpest, 3.0);
  EXPECT_TRUE(fastest > 0.8 || sharpest > 1.5) << fastest << " " << sharpest;
}

TEST(Line, to_where_the_tool_is_lasts_as_long_as_the_shortest_move) {
  const Arm6 arm;
  const Pose here = *tool_pose(arm.model, arm.from);
  EXPECT_NEAR(plan_line(arm.configuration, arm.model, arm.from, here)->duration_s, 1.05 * 0.02,
              1e-12);
}

TEST(Line, is_straight_and_turns_about_one_axis) {
  const Arm6 arm;
  Move line;
  line.X_RT_from = *tool_pose(arm.model, arm.from);
  line.X_RT_to = line.X_RT_from;
  line.X_RT_to.p += Vector3(0.1, -0.2, 0.3);
  const Vector3 axis = Vector3(1, 2, -2) / 3;
  line.X_RT_to.R = line.X_RT_from.R * rotation_about(axis, 0.8);
  for (const double s : {0.0, 0.25, 1.0}) {
    const Pose at = line_pose(line, s);
    EXPECT_LT((at.p - line.X_RT_from.p - s * Vector3(0.1, -0.2, 0.3)).norm(), 1e-15);
    EXPECT_LT((rotation_vector(line.X_RT_from.R.transpose() * at.R) - s * 0.8 * axis).norm(),
              1e-12);
  }
}

TEST(Line, is_refused_with_a_pace_or_an_end_that_is_no_number) {
  const Arm6 arm;
  const Pose here = *tool_pose(arm.model, arm.from);
  for (const double pace : {0.0, -1.0, 1.0 + 1e-9, kNan}) {
    EXPECT_EQ(test::failure_of(plan_line(arm.configuration, arm.model, arm.from, here, pace)).error,
              Error::kOutOfRange);
  }
  Pose nowhere = here;
  nowhere.p.y() = kNan;
  EXPECT_EQ(test::failure_of(plan_line(arm.configuration, arm.model, arm.from, nowhere)).error,
            Error::kNotFinite);
  nowhere = here;
  nowhere.R(2, 1) = kNan;
  EXPECT_EQ(test::failure_of(plan_line(arm.configuration, arm.model, arm.from, nowhere)).error,
            Error::kNotFinite);
  JointVector lost = arm.from;
  lost[3] = kNan;
  EXPECT_EQ(test::failure_of(plan_line(arm.configuration, arm.model, lost, here)).error,
            Error::kNotFinite);
}

TEST(Line, whose_end_is_further_than_the_arm_is_long_is_out_of_reach_at_once) {
  const Arm6 arm;
  Pose to = *tool_pose(arm.model, arm.from);
  to.p.x() += 10;
  LinePlanning planning(arm.configuration, arm.model, arm.from, to, 1);
  EXPECT_EQ(test::failure_of(planning.result()).error, Error::kOutOfReach) << "before a step";
  EXPECT_FALSE(planning.step());
}

TEST(Line, of_an_arm_with_a_slide_may_be_as_long_as_the_slide) {
  Arm6 arm;
  arm.configuration.drawing.joints[3].type = JointType::kPrismatic;
  arm.configuration.drawing.limits[3] = {-0.1, 0.3};
  Pose to = *tool_pose(arm.model, arm.from);
  to.p.x() += 6;
  const auto at_once = [&] {
    return LinePlanning(arm.configuration, arm.model, arm.from, to, 1).result();
  };
  EXPECT_EQ(test::failure_of(at_once()).error, Error::kOutOfReach);
  arm.configuration.drawing.limits[3].upper = 5;
  EXPECT_TRUE(at_once());
}

TEST(Line, that_a_motor_cant_follow_is_refused_for_its_joint) {
  Arm6 arm;
  arm.configuration.drawing.couplings.push_back({.joint = 5, .from = 4, .ratio = 1});
  Pose to = *tool_pose(arm.model, arm.from);
  to.p.z() -= 0.1;
  ASSERT_TRUE(plan_line(arm.configuration, arm.model, arm.from, to));
  const JointVector motors = readings_for(arm.configuration.drawing.couplings, arm.from);
  arm.configuration.drawing.limits[5] = {motors[5] - 1e-3, motors[5] + 1e-3};
  const auto refusal = test::failure_of(plan_line(arm.configuration, arm.model, arm.from, to));
  EXPECT_EQ(refusal.error, Error::kJointLimit);
  EXPECT_EQ(refusal.joint, 5U);
}

TEST(ReadingsAt, of_a_joint_move_are_on_the_straight_line_between_its_ends) {
  const Arm6 arm;
  const Planned move = plan_joint_move(arm.configuration, arm.from, arm.moved(3, 1.0));
  ASSERT_TRUE(move);
  calibration::LatelyTurned lately;
  const auto at = [&](double s) {
    return *readings_at(*move, arm.configuration, arm.model, arm.from, s, lately);
  };
  EXPECT_EQ(at(0)[3], arm.from[3]);
  EXPECT_NEAR(at(0.25)[3], arm.from[3] + 0.25, 1e-12);
  EXPECT_NEAR(at(1)[3], arm.from[3] + 1.0, 1e-12);
  EXPECT_EQ(at(0.5)[0], arm.from[0]);
}

// In the tick, where a plan would have told before: a line that goes on where the arm does not.
TEST(ReadingsAt, of_a_place_that_the_arm_does_not_come_to_are_none) {
  Arm6 arm;
  for (double& speed : arm.configuration.limits.speed) speed = 1e4;
  const auto error_of = [&](const JointVector& from, const Vector3& by) {
    Move line;
    line.kind = MoveKind::kLine;
    line.from = line.to = from;
    line.duration_s = 1;
    line.X_RT_from = line.X_RT_to = *tool_pose(arm.model, from);
    line.X_RT_to.p += by;
    calibration::LatelyTurned lately;
    return test::failure_of(readings_at(line, arm.configuration, arm.model, from, 1, lately));
  };
  // Stretched, and straight on.
  JointVector stretched = arm.from;
  stretched[2] = radians(90);
  const auto frames = dh_frames(arm.configuration.drawing.joints, stretched);
  EXPECT_EQ(error_of(stretched, 0.02 * (frames[4].p - frames[1].p).normalized()),
            Error::kSingularPath);
  // Round the base, which a joint at its limit does not go.
  auto limits = arm.configuration.drawing.limits;
  limits[0] = {arm.from[0] - 1e-4, arm.from[0] + 1e-4};
  arm.model.chain = kinematics::make_chain(arm.configuration.drawing.joints, limits);
  const Vector3 p = tool_pose(arm.model, arm.from)->p;
  EXPECT_EQ(error_of(arm.from, rotation_z(0.02) * p - p), Error::kNotConverged);
}

}  // namespace
}  // namespace armsig::controller
