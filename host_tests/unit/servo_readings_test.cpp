// SPDX-License-Identifier: MIT
// Gravity and joint error maps in the servo tick: against the estimator's own evaluation, and
// the inverse against the forward.
#include <limits>

#include <gtest/gtest.h>

#include "core/calibration/readings.hpp"
#include "core/calibration/servo_inverse.hpp"
#include "core/identification.hpp"
#include "core/kinematics/forward.hpp"
#include "host_tests/support/bent_model.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::calibration {
namespace {

using test::Random;

struct Bent {
  Arm arm;
  ArmModel model;
  JointVector configuration;
  ServoReadings joints;
};

Bent bent_arm(const Arm& arm, Random& random) {
  Bent bent_one{arm, test::bent_model(arm, random), {}, {}};
  bent_one.configuration = effective_readings(arm, random.configuration(arm));
  bent_one.joints = ServoReadings(packed(bent_one.model), arm, bent_one.configuration);
  return bent_one;
}

std::vector<Arm> arms() {
  std::vector<Arm> all{test::puma(), test::ur5(), test::stanford(), test::cobra600(),
                       test::iiwa7()};
  Arm coupled = test::puma();
  coupled.couplings.push_back({2, 1, -1});
  all.push_back(coupled);
  return all;
}

TEST(ServoReadings, turns_the_joints_as_the_estimator_does) {
  Random random(3);
  for (const Arm& arm : arms()) {
    const Bent bent = bent_arm(arm, random);
    const ReadingModel model{arm.couplings, {}, &bent.model};
    for (int k = 0; k < 200; ++k) {
      const JointVector readings = random.configuration(arm);
      const JointVector q = effective_readings(arm, readings);
      const auto turned = bent.joints.turned(q);
      ASSERT_TRUE(turned);
      const JointVector expected = true_readings(model, bent.configuration, readings);
      for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR((*turned)[i], expected[i], 3e-8);
    }
    const auto at_rest = bent.joints.turned(bent.configuration);
    ASSERT_TRUE(at_rest);
    for (std::size_t i = 0; i < at_rest->size(); ++i) {
      EXPECT_NEAR((*at_rest)[i], bent.configuration[i], 1e-15);
    }
  }
}

TEST(ServoReadings, gives_readings_that_turn_the_joints_where_they_are_wanted) {
  Random random(5);
  for (const Arm& arm : arms()) {
    const Bent bent = bent_arm(arm, random);
    for (int k = 0; k < 300; ++k) {
      const JointVector wanted = effective_readings(arm, random.configuration(arm));
      const auto q = bent.joints.readings(wanted);
      ASSERT_TRUE(q);
      const auto turned = bent.joints.turned(*q);
      ASSERT_TRUE(turned);
      for (std::size_t i = 0; i < q->size(); ++i) {
        EXPECT_NEAR((*turned)[i], wanted[i], 5e-10);
        EXPECT_LT(std::abs((*q)[i] - wanted[i]), bent.joints.largest());
      }
    }
  }
}

TEST(ServoReadings, brings_the_last_frame_to_its_pose_within_a_nanometre) {
  Random random(7);
  const Arm arm = test::puma();
  const Bent bent = bent_arm(arm, random);
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, bent.joints.turned_limits());
  double worst_m = 0;
  int met = 0;
  for (int k = 0; k < 2000; ++k) {
    const JointVector q = random.configuration(arm);
    const auto turned = bent.joints.turned(q);
    ASSERT_TRUE(turned);
    const auto X_0n = kinematics::forward(chain, *turned);
    ASSERT_TRUE(X_0n);
    JointVector seed = q;
    for (double& reading : seed) reading += random.uniform(-1, 1) * radians(0.5);
    const auto found = inverse(chain, bent.joints, *X_0n, seed);
    ASSERT_TRUE(found);
    if (found->verdict != kinematics::Verdict::kConverged) continue;
    ++met;
    const auto there = bent.joints.turned(found->q);
    ASSERT_TRUE(there);
    const auto X = kinematics::forward(chain, *there);
    ASSERT_TRUE(X);
    worst_m = std::max(worst_m, (X->p - X_0n->p).norm());
  }
  EXPECT_GT(met, 1900);
  EXPECT_LT(worst_m, 1e-9);
}

// One to six joints, revolute or prismatic, links of any length and twist.
Arm any_arm(Random& random) {
  Arm arm;
  const auto joints = static_cast<std::size_t>(random.uniform(1, 7));
  for (std::size_t i = 0; i < joints; ++i) {
    DhJoint row;
    row.type = random.uniform(0, 1) < 0.25 ? JointType::kPrismatic : JointType::kRevolute;
    row.theta_rad = random.uniform(-3, 3);
    row.d_m = random.uniform(-0.5, 0.5);
    row.a_m = random.uniform(0.1, 0.6);
    row.alpha_rad = random.uniform(-1.6, 1.6);
    arm.joints.push_back(row);
    const double most = row.type == JointType::kRevolute ? 3 : 0.6;
    arm.limits.push_back({-most, random.uniform(0.5, 1) * most});
  }
  return arm;
}

// Of poses that the arm can be at, as it has been there.
TEST(ServoReadings, agree_forward_and_back_within_a_nanometre_on_any_arm) {
  Random random(17);
  double worst_m = 0;
  int met = 0;
  for (int one = 0; one < 150; ++one) {
    const Arm arm = any_arm(random);
    const Bent bent = bent_arm(arm, random);
    const kinematics::Chain chain = kinematics::make_chain(arm.joints, bent.joints.turned_limits());
    for (int k = 0; k < 20; ++k) {
      const JointVector q = random.configuration(arm);
      const Pose X_0n = *forward(chain, bent.joints, q);
      JointVector seed = q;
      for (double& reading : seed) reading += random.uniform(-1, 1) * 2e-3;
      const auto found = inverse(chain, bent.joints, X_0n, seed);
      ASSERT_TRUE(found);
      if (found->verdict != kinematics::Verdict::kConverged) continue;
      ++met;
      const auto X = forward(chain, bent.joints, found->q);
      ASSERT_TRUE(X);
      worst_m = std::max(worst_m, (X->p - X_0n.p).norm());
    }
  }
  EXPECT_GT(met, 2400);
  EXPECT_LT(worst_m, 1e-9);
}

// A servo's own: each tick begins with what the one before has found. Steps of every size, and a
// jump, which a guess from before it must not survive.
TEST(ServoReadings, follow_a_path_with_what_the_tick_before_has_found) {
  Random random(19);
  for (const Arm& arm : arms()) {
    const Bent bent = bent_arm(arm, random);
    JointVector wanted = effective_readings(arm, random.configuration(arm));
    LatelyTurned lately;
    for (int tick = 0; tick < 400; ++tick) {
      const double step = tick % 100 == 99 ? 0.5 : 1e-4 * (tick % 100);
      for (double& joint : wanted) joint += step * random.uniform(-1, 1);
      const auto q = bent.joints.readings(wanted, lately);
      ASSERT_TRUE(q);
      const auto turned = bent.joints.turned(*q);
      ASSERT_TRUE(turned);
      for (std::size_t i = 0; i < q->size(); ++i) EXPECT_NEAR((*turned)[i], wanted[i], 1.5e-10);
    }
  }
}

TEST(ServoReadings, keeps_the_limits_of_the_readings_and_the_step_asked_for) {
  Random random(9);
  const Arm arm = test::puma();
  const Bent bent = bent_arm(arm, random);
  const kinematics::Chain chain = kinematics::make_chain(arm.joints, bent.joints.turned_limits());
  JointVector q{0.3, -1, 1, 0.2, 0.8, 0.1};
  const auto pose_at = [&](const JointVector& readings) {
    return *kinematics::forward(chain, *bent.joints.turned(readings));
  };
  q[0] = arm.limits[0].upper + radians(0.005);  // the joint itself may have turned no further
  auto found = inverse(chain, bent.joints, pose_at(q), q);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, kinematics::Verdict::kJointLimit);
  q[0] = arm.limits[0].upper - radians(0.001);
  found = inverse(chain, bent.joints, pose_at(q), q);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, kinematics::Verdict::kConverged);

  q[0] = 0.3;
  JointVector seed = q;
  seed[3] -= 1.01e-3;
  kinematics::InverseOptions options;
  options.max_step = JointVector{1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3};
  found = inverse(chain, bent.joints, pose_at(q), seed, options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, kinematics::Verdict::kStepLimit);
  options.max_step[3] = 1.02e-3;
  found = inverse(chain, bent.joints, pose_at(q), seed, options);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->verdict, kinematics::Verdict::kConverged);
}

TEST(ServoReadings, refuses_what_is_no_reading) {
  Random random(11);
  const Bent bent = bent_arm(test::puma(), random);
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e7}) {
    JointVector q = bent.configuration;
    q[2] = value;
    const auto turned = bent.joints.turned(q);
    EXPECT_EQ(test::failure_of(turned), Error::kNotFinite);
    EXPECT_FALSE(bent.joints.readings(q));
  }
}

TEST(ServoReadings, say_everything_where_there_are_no_deflections) {
  const ServoReadings joints;
  const JointVector q{1, 2, 3};
  EXPECT_TRUE(joints.exact());
  for (const auto& same : {joints.turned(q), joints.readings(q)}) {
    ASSERT_TRUE(same);
    for (std::size_t i = 0; i < q.size(); ++i) EXPECT_EQ((*same)[i], q[i]);
  }
}

TEST(PackedDeflections, are_the_same_again_when_they_were_unpacked) {
  Random random(21);
  const Arm arm = test::stanford();
  const PackedDeflections deflections = packed(test::bent_model(arm, random));
  const PackedDeflections again = packed(unpacked(deflections, arm));
  ASSERT_EQ(again.maps.size(), deflections.maps.size());
  for (std::size_t i = 0; i < again.maps.size(); ++i) {
    EXPECT_EQ(again.maps[i].steps, deflections.maps[i].steps);
    EXPECT_NEAR(again.maps[i].step, deflections.maps[i].step, 1e-14 * deflections.maps[i].step);
    EXPECT_EQ(again.maps[i].domain.per_length, deflections.maps[i].domain.per_length);
    EXPECT_EQ(again.drawn_zero[i], deflections.drawn_zero[i]);
  }
  ASSERT_EQ(again.gravity.size(), deflections.gravity.size());
  EXPECT_EQ(again.gravity[0].coefficient, deflections.gravity[0].coefficient);
}

TEST(PackedDeflections, are_refused_where_a_reading_could_jump) {
  Random random(13);
  const Arm arm = test::ur5();
  const PackedDeflections sound = packed(test::bent_model(arm, random));
  ASSERT_TRUE(check(sound, arm));
  const auto refused = [&](const PackedDeflections& deflections) {
    const auto checked = check(deflections, arm);
    return !checked && checked.error() == Error::kOutOfRange;
  };
  PackedDeflections jump = sound;
  jump.maps[2].step = 1e-6;
  jump.maps[2].steps.fill(0);
  jump.maps[2].steps[60] = 32000;  // 32 mrad within 3 degrees
  EXPECT_TRUE(refused(jump));
  PackedDeflections far = sound;
  far.maps[0].step = 4e-6;
  far.maps[0].steps.fill(32000);  // smooth, and 7 degrees
  EXPECT_TRUE(refused(far));
  PackedDeflections dense = sound;
  dense.maps[1].domain.per_length *= 1e4;
  EXPECT_TRUE(refused(dense));
  PackedDeflections heavy = sound;
  heavy.gravity[0].coefficient = 0.11;
  EXPECT_TRUE(refused(heavy));
  PackedDeflections backwards = sound;
  backwards.gravity[0].origin = backwards.gravity[0].joint;
  EXPECT_TRUE(refused(backwards));
  PackedDeflections nan = sound;
  nan.maps[5].step = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused(nan));
  Arm shorter = arm;
  shorter.joints.resize(5);
  EXPECT_FALSE(check(sound, shorter));
  PackedDeflections askew = sound;
  askew.up_0 = {0, 0, 1.001};
  EXPECT_TRUE(refused(askew));
}

TEST(PackedDeflections, hold_the_steepest_map_that_is_taken_and_its_inverse_converges) {
  const Arm arm = test::puma();
  ArmModel model = model_of(arm, {});
  for (JointModel& joint : model.joints) {
    for (std::size_t k = 0; k < kKnots; ++k) {
      joint.map[k] = (k % 4 < 2 ? 1 : -1) * 0.049 * 0.5 * (2 * kPi / kKnots) / map_unit(joint.type);
    }
  }
  const PackedDeflections deflections = packed(model);
  ASSERT_TRUE(check(deflections, arm));
  const ServoReadings joints(deflections, arm, JointVector{0, 0, 0, 0, 0, 0});
  Random random(15);
  for (int k = 0; k < 300; ++k) {
    const JointVector wanted = random.configuration(arm);
    const auto q = joints.readings(wanted);
    ASSERT_TRUE(q);
    const auto turned = joints.turned(*q);
    ASSERT_TRUE(turned);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR((*turned)[i], wanted[i], 5e-10);
  }
}

}  // namespace
}  // namespace armsig::calibration
