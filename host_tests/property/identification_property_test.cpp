// SPDX-License-Identifier: MIT
// Exact features of any arm give a model that is exact at any readings.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "core/pseudo_dh/pseudo_dh.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig {
namespace {

using test::ExactArm;
using test::kR;
using test::Random;

struct WorstErrors {
  double position_m = 0;
  double orientation_rad = 0;

  void take(const Pose& found, const Pose& truth, const Vector3& p_F) {
    position_m = std::max(position_m, (found * p_F - truth * p_F).norm());
    orientation_rad = std::max(orientation_rad, angle_between(found.R, truth.R));
  }
};

struct ModelErrors {
  WorstErrors pseudo_dh;
  WorstErrors link_frames;
};

// Both models of an identified arm against the arm at random readings: pose of the tool, whose
// place in link frame n follows from the signature configuration.
ModelErrors errors_of(const Signature& signature, const ExactArm& exact, Random& random) {
  const std::size_t n = exact.count();
  const Pose X_LF = signature.X_SL[n].inverse() * exact.tool_pose(exact.q_s);
  const Pose X_FL = pseudo_dh::link_frame_in_dh_frame(signature.s_model[n - 1]);
  ModelErrors worst;
  for (int i = 0; i < 20; ++i) {
    const JointVector q = random.readings(exact.arm, kPi, 0.5);
    const Pose truth = exact.tool_pose(q);
    const Pose X_Sn = test::plain_dh_pose(signature.pseudo_dh, q, n, signature.X_SL[0]);
    worst.pseudo_dh.take(X_Sn * X_FL * X_LF, truth, exact.p_F);
    worst.link_frames.take(kinematics::link_pose(signature, q, n) * X_LF, truth, exact.p_F);
  }
  return worst;
}

void expect_exact(const ExactArm& exact, const Arm& nominal, Random& random) {
  const auto signature = identify(test::exact_features(exact), exact.q_s, nominal);
  ASSERT_TRUE(signature);
  EXPECT_TRUE(signature->description_matches);
  const ModelErrors worst = errors_of(*signature, exact, random);
  EXPECT_LT(worst.pseudo_dh.position_m, 1e-9);
  EXPECT_LT(worst.pseudo_dh.orientation_rad, 1e-9);
  EXPECT_LT(worst.link_frames.position_m, 1e-11);
  EXPECT_LT(worst.link_frames.orientation_rad, 1e-11);
}

TEST(IdentificationOfKnownArms, is_exact_at_any_readings) {
  Random random(1);
  for (const test::KnownArm& known : test::known_arms()) {
    for (int i = 0; i < 10; ++i) {
      SCOPED_TRACE(known.name);
      const ExactArm exact{known, random.readings(known, 3, 0.5), random.pose(3)};
      expect_exact(exact, known.drawing, random);
      expect_exact(exact, known, random);
    }
  }
}

TEST(IdentificationOfRandomArms, is_exact_at_any_readings) {
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    const Arm arm = test::random_arm(random);
    expect_exact({arm, random.readings(arm, 3, 0.5), random.pose(3)}, arm, random);
  }
}

TEST(IdentificationOfRandomArms, is_exact_many_turns_from_zero) {
  Random random(3);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const Arm arm = test::random_arm(random);
    expect_exact({arm, random.readings(arm, 500, 5), random.pose(3)}, arm, random);
  }
}

TEST(IdentificationOfRandomArms, does_not_depend_on_the_drawing_that_chooses_the_branch) {
  Random random(4);
  for (int i = 0; i < 50; ++i) {
    SCOPED_TRACE(i);
    const Arm arm = test::random_arm(random);
    const ExactArm exact{arm, random.readings(arm, 3, 0.5), random.pose(3)};
    auto signature = identify(test::exact_features(exact), exact.q_s, arm);
    ASSERT_TRUE(signature);
    Arm other = arm;
    for (DhJoint& row : other.joints) row.alpha_rad = random.uniform(-kPi, kPi);
    derive_parameters(*signature, other);
    EXPECT_LT(errors_of(*signature, exact, random).pseudo_dh.position_m, 1e-9);
  }
}

// A joint 0.7 m from its neighbour, its axis off parallel (or antiparallel) by `tilt_rad` in any
// direction, and a third axis across; the truth is built from frames near the arm.
Signature near_parallel_arm(double tilt_rad, Random& random) {
  const Matrix3 turned = rotation_z(random.uniform(-3, 3)) *
                         rotation_x(random.index(2) == 0 ? 0.0 : kPi) *
                         rotation_z(random.uniform(-3, 3));
  const Vector3 across = rotation_z(random.uniform(-3, 3)).col(0);
  const Vector3 apart = 0.7 * rotation_z(random.uniform(-3, 3)).col(0);
  Signature signature;
  signature.types = {kR, kR, kR};
  signature.configuration = {random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
  signature.X_SL.push_back(random.pose(2));
  signature.X_SL.push_back(signature.X_SL[0] *
                           Pose{rotation_about(across, tilt_rad) * turned, apart});
  signature.X_SL.push_back(signature.X_SL[1] * random.pose(0.6));
  signature.X_SL.push_back(Pose(signature.X_SL[2]));
  derive_parameters(signature, test::make_arm({{kR, 0, 0, 0.5, 0}, {kR, 0, 0, 0.5, 1.5}, {}}, {}));
  return signature;
}

WorstErrors pseudo_dh_errors(double tilt_rad) {
  Random random(5);
  WorstErrors worst;
  for (int arm = 0; arm < 100; ++arm) {
    const Signature signature = near_parallel_arm(tilt_rad, random);
    const Pose X_FL = pseudo_dh::link_frame_in_dh_frame(signature.s_model[2]);
    for (int i = 0; i < 20; ++i) {
      const JointVector q{random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3)};
      const Pose found = test::plain_dh_pose(signature.pseudo_dh, q, 3, signature.X_SL[0]) * X_FL;
      worst.take(found, kinematics::link_pose(signature, q, 3), Vector3(0.1, 0.1, 0.1));
    }
  }
  return worst;
}

TEST(NearParallelAxes, pseudo_dh_product_is_exact_outside_the_gap_about_the_threshold) {
  for (const double tilt_rad :
       {0.0, 1e-15, 1e-12, 1e-11, 1e-10, 4e-10, 5e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    const WorstErrors worst = pseudo_dh_errors(tilt_rad);
    EXPECT_LT(worst.position_m, 1.5e-9) << tilt_rad;
    EXPECT_LT(worst.orientation_rad, 1e-9) << tilt_rad;
  }
}

TEST(NearParallelAxes, pseudo_dh_product_is_never_worse_than_at_the_threshold) {
  for (const double tilt_rad :
       {1e-9, 5e-9, 0.99 * s_model::kParallelSine, 1.01 * s_model::kParallelSine, 3e-8, 1e-7}) {
    EXPECT_LT(pseudo_dh_errors(tilt_rad).position_m, 5e-8) << tilt_rad;
  }
}

TEST(NearParallelAxes, threshold_stands_where_making_parallel_costs_as_much_as_keeping_the_tilt) {
  const double parallel_m = pseudo_dh_errors(0.99 * s_model::kParallelSine).position_m;
  const double kept_m = pseudo_dh_errors(1.01 * s_model::kParallelSine).position_m;
  EXPECT_LT(parallel_m, 2 * kept_m);
  EXPECT_LT(kept_m, 2 * parallel_m);
}

TEST(MirroredSense, of_one_joint_is_found_in_any_known_arm) {
  Random random(6);
  for (const test::KnownArm& known : test::known_arms()) {
    for (std::size_t joint = 0; joint < known.joints.size(); ++joint) {
      SCOPED_TRACE(known.name);
      const ExactArm exact{known, random.readings(known, 2.5, 0.5), random.pose(3)};
      auto features = test::exact_features(exact);
      JointVector q = exact.q_s;
      features[joint].axis_S *= -1.0;
      features[joint].reference_reading *= -1.0;
      q[joint] *= -1.0;
      const auto signature = identify(features, q, known.drawing);
      ASSERT_FALSE(signature);
      EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kMirroredSense);
      EXPECT_EQ(test::failure_of(signature).joint, joint);
    }
  }
}

TEST(MirroredSense, is_not_seen_where_the_drawing_has_its_zeros_wrong) {
  Random random(7);
  for (const test::KnownArm& known : test::known_arms()) {
    for (int i = 0; i < 10; ++i) {
      SCOPED_TRACE(known.name);
      const ExactArm exact{known, random.readings(known, 2.5, 0.5), random.pose(3)};
      Arm drawing = known.drawing;
      for (DhJoint& row : drawing.joints) {
        if (row.type == kR) row.theta_rad += radians(random.uniform(-40, 40));
      }
      EXPECT_TRUE(identify(test::exact_features(exact), exact.q_s, drawing));
    }
  }
}

}  // namespace
}  // namespace armsig
