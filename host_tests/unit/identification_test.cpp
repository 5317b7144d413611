// SPDX-License-Identifier: MIT
#include "core/identification.hpp"

#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/kinematics/s_model_chain.hpp"
#include "core/pseudo_dh/pseudo_dh.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig {
namespace {

using test::ExactArm;
using test::kP;
using test::kR;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

ExactArm puma() {
  return {test::puma560(),
          {0.3, -0.4, 0.9, 0.2, -0.7, 0.1},
          Pose{rotation_z(0.5) * rotation_x(0.1), Vector3(1, -2, 0.3)}};
}

// Three joints R, P, R given by their axes. The rows were computed from the geometry of the common
// normals (feet of the normals, angles between them) with 40 digits (Python, mpmath).
FixedVector<features::JointFeature, kMaxJoints> golden_features() {
  FixedVector<features::JointFeature, kMaxJoints> features(3);
  features[0].axis_S = Vector3(1, 2, 2) / 3;
  features[0].point_S = {0.5, 0.2, 0.9};
  features[0].radial_S = Vector3(1, 2, 2).cross(Vector3::UnitZ()).normalized();
  features[1].type = kP;
  features[1].axis_S = Vector3(2, -1, 3).normalized();
  features[1].point_S = {1.1, 0.3, 0.7};
  features[1].reference_reading = 0.15;
  features[2].axis_S = Vector3(-3, 1, 4).normalized();
  features[2].point_S = {0.8, -0.4, 1.2};
  features[2].radial_S = Vector3(-3, 1, 4).cross(Vector3::UnitX()).normalized();
  return features;
}
Arm golden_drawing() {
  return test::make_arm(
      {{kR, 0.4, 0.1, 0.6, 1.0}, {kP, -2.0, 0.3, 0.7, 1.3}, {kR, -1.8, 0.3, 0, 0}}, {});
}

TEST(Identify, finds_the_golden_rows_of_three_axes) {
  const auto signature = identify(golden_features(), {0.4, 0.15, -0.9}, golden_drawing());
  ASSERT_TRUE(signature);
  const auto& rows = signature->pseudo_dh;
  EXPECT_NEAR(rows[0].theta_rad, 0.38539816339744831, 2e-15);
  EXPECT_NEAR(rows[0].d_m, 0.0866666666666666667, 2e-15);
  EXPECT_NEAR(rows[0].a_m, 0.621914606499781269, 2e-15);
  EXPECT_NEAR(rows[0].alpha_rad, 1.00685368543426778, 2e-15);
  EXPECT_NEAR(rows[1].theta_rad, -1.97067115933258656, 2e-15);
  EXPECT_NEAR(rows[1].d_m, 0.275047864202550097, 2e-15);
  EXPECT_NEAR(rows[1].a_m, 0.733219352901317348, 2e-15);
  EXPECT_NEAR(rows[1].alpha_rad, 1.30562852451797914, 2e-15);
  EXPECT_NEAR(rows[2].theta_rad, -1.75210253381514769, 2e-15);
  EXPECT_NEAR(rows[2].d_m, 0.342942905338983758, 2e-15);
  EXPECT_EQ(rows[2].a_m, 0.0);
  EXPECT_EQ(rows[2].alpha_rad, 0.0);
}

TEST(Identify, keeps_types_configuration_and_features) {
  const JointVector q{0.4, 0.15, -0.9};
  const auto signature = identify(golden_features(), q, golden_drawing());
  ASSERT_TRUE(signature);
  EXPECT_EQ(signature->joint_count(), 3U);
  EXPECT_EQ(signature->types[1], kP);
  EXPECT_EQ(signature->configuration[2], -0.9);
  EXPECT_EQ(signature->features.size(), 3U);
  EXPECT_EQ(signature->X_SL.size(), 4U);
  EXPECT_TRUE(signature->targets.empty());
}

// Table 2 from exact features. theta and d of links 1 and 6 hold for the frames 0 and n of the
// authors; ours are turned and slid about the same z axis, by the turn and slide measured here.
void expect_table_2(const Arm& arm) {
  const ExactArm exact{arm, {0.4, -0.7, 0.9, 0.3, 0.8, -0.5}, Pose{rotation_x(0.3), {1, 2, 0.5}}};
  const auto signature = identify(test::exact_features(exact), exact.q_s, test::puma560());
  ASSERT_TRUE(signature);
  EXPECT_TRUE(signature->description_matches);
  DhRows rows = signature->pseudo_dh;

  const Pose X_00 = exact.X_S0.inverse() * signature->X_SL[0];
  EXPECT_NEAR(X_00.R(2, 2), 1, 1e-14);
  rows[0].theta_rad += std::atan2(X_00.R(1, 0), X_00.R(0, 0));
  rows[0].d_m += X_00.p.z();
  const Pose X_Sn =
      signature->X_SL[0] * test::rounded(test::dh_pose(signature->pseudo_dh, exact.q_s, 6, Pose{}));
  const Pose X_nn = X_Sn.inverse() * exact.tool_pose(exact.q_s);
  EXPECT_NEAR(X_nn.R(2, 2), 1, 1e-14);
  rows[5].theta_rad += std::atan2(X_nn.R(1, 0), X_nn.R(0, 0));
  rows[5].d_m += X_nn.p.z();

  for (std::size_t i = 0; i < 6; ++i) {
    SCOPED_TRACE(i + 1);
    // Half a unit of the last digit printed: 0.001 degrees, 0.001 cm. The answer is far closer.
    EXPECT_NEAR(degrees(wrap_angle(rows[i].theta_rad)), degrees(arm.joints[i].theta_rad), 1e-8);
    EXPECT_NEAR(rows[i].d_m, arm.joints[i].d_m, 1e-7);
    EXPECT_NEAR(rows[i].a_m, arm.joints[i].a_m, 1e-9);
    EXPECT_NEAR(degrees(rows[i].alpha_rad), degrees(arm.joints[i].alpha_rad), 1e-11);
  }
}

TEST(Identify, gives_table_2_of_robot_1_back) { expect_table_2(test::puma560_robot1()); }
TEST(Identify, gives_table_2_of_robot_2_back) { expect_table_2(test::puma560_robot2()); }

TEST(Identify, warns_of_a_drawing_of_another_arm) {
  Arm other = test::puma560();
  for (DhJoint& row : other.joints) row.alpha_rad += radians(60);
  const auto signature = identify(test::exact_features(puma()), puma().q_s, other);
  ASSERT_TRUE(signature);
  EXPECT_FALSE(signature->description_matches);
}

TEST(Identify, refuses_a_feature_that_is_not_finite_and_names_the_joint) {
  for (int part = 0; part < 4; ++part) {
    auto features = test::exact_features(puma());
    if (part == 0) features[3].axis_S.x() = kNaN;
    if (part == 1) features[3].point_S.y() = kNaN;
    if (part == 2) features[3].radial_S.z() = kNaN;
    if (part == 3) features[3].reference_reading = kNaN;
    const auto signature = identify(features, puma().q_s, test::puma560());
    ASSERT_FALSE(signature);
    EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kNotFinite);
    EXPECT_EQ(test::failure_of(signature).joint, 3U);
  }
}

TEST(Identify, refuses_an_axis_without_direction) {
  auto features = test::exact_features(puma());
  features[2].axis_S.setZero();
  const auto signature = identify(features, puma().q_s, test::puma560());
  ASSERT_FALSE(signature);
  EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kNotFinite);
  EXPECT_EQ(test::failure_of(signature).joint, 2U);
}

TEST(Identify, refuses_a_reading_that_is_not_finite) {
  JointVector q = puma().q_s;
  q[5] = std::numeric_limits<double>::infinity();
  const auto signature = identify(test::exact_features(puma()), q, test::puma560());
  ASSERT_FALSE(signature);
  EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kNotFinite);
  EXPECT_EQ(test::failure_of(signature).joint, 5U);
}

TEST(Identify, refuses_a_joint_that_turns_backwards_and_names_it) {
  auto features = test::exact_features(puma());
  JointVector q = puma().q_s;
  features[1].axis_S *= -1.0;
  features[1].reference_reading *= -1.0;
  q[1] = -q[1];
  const auto signature = identify(features, q, test::puma560());
  ASSERT_FALSE(signature);
  EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kMirroredSense);
  EXPECT_GT(test::failure_of(signature).refusal.found, test::failure_of(signature).refusal.needed);
  EXPECT_EQ(test::failure_of(signature).joint, 1U);
  EXPECT_EQ(test::failure_of(signature).sense.verdict, frames::SenseVerdict::kJointsReversed);
}

TEST(Identify, refuses_a_left_handed_sensor) {
  auto features = test::exact_features(puma());
  for (features::JointFeature& feature : features) {
    feature.point_S.z() *= -1.0;
    feature.radial_S.z() *= -1.0;
    feature.axis_S.z() *= -1.0;
    feature.axis_S *= -1.0;
  }
  const auto signature = identify(features, puma().q_s, test::puma560());
  ASSERT_FALSE(signature);
  EXPECT_EQ(test::failure_of(signature).refusal.error, Error::kMirroredSense);
  EXPECT_EQ(test::failure_of(signature).sense.verdict, frames::SenseVerdict::kSensorMirrored);
}

TEST(Identify, traps_when_counts_or_types_differ) {
  const auto features = test::exact_features(puma());
  EXPECT_DEATH(EXPECT_FALSE(identify({}, {}, Arm{})), "");
  EXPECT_DEATH(EXPECT_FALSE(identify(features, {0.1}, test::puma560())), "");
  EXPECT_DEATH(EXPECT_FALSE(identify(features, puma().q_s, test::cobra600())), "");
  EXPECT_DEATH(EXPECT_FALSE(identify(features, puma().q_s, test::stanford())), "");
}

TEST(DeriveParameters, leaves_the_link_frames_as_they_are) {
  Signature signature = signature_of(test::puma560_robot1(), JointVector(6, 0.2), Pose{}, {});
  const auto before = signature.X_SL;
  signature.X_SL[3].p.x() += 1e-3;
  derive_parameters(signature, test::puma560());
  EXPECT_EQ(signature.X_SL[3].p.x(), before[3].p.x() + 1e-3);
  EXPECT_EQ(signature.X_SL[4].R, before[4].R);
}

TEST(DeriveParameters, follows_frames_that_a_refinement_has_moved) {
  Signature signature = signature_of(test::puma560(), JointVector(6, 0.2), Pose{}, {});
  signature.X_SL[6].p += 1e-3 * signature.X_SL[6].R.col(0);
  derive_parameters(signature, test::puma560());
  EXPECT_NEAR(std::abs(signature.pseudo_dh[5].a_m), 1e-3, 1e-15);
}

TEST(SignatureOf, gives_the_rows_of_the_arm_back) {
  for (const test::KnownArm& known : test::known_arms()) {
    SCOPED_TRACE(known.name);
    const JointVector q(known.joints.size(), 0.25);
    const Signature signature = signature_of(known, q, test::Random(5).pose(2), {});
    for (std::size_t i = 0; i < q.size(); ++i) {
      const DhJoint& found = signature.pseudo_dh[i];
      const DhJoint& truth = known.joints[i];
      const double tilt = std::abs(std::sin(truth.alpha_rad));
      if (tilt < s_model::kParallelSine) continue;  // d of parallel axes is free
      // A near-parallel normal amplifies rounding by 1 / sine, twice for d.
      EXPECT_NEAR(found.alpha_rad, truth.alpha_rad, 1e-14);
      EXPECT_NEAR(found.a_m, truth.a_m, 1e-13 / tilt);
    }
  }
}

TEST(SignatureOf, ends_in_the_arms_own_last_frame) {
  const ExactArm exact = puma();
  const Signature signature = signature_of(exact.arm, exact.q_s, exact.X_S0, {});
  const Pose X_Sn = exact.tool_pose(exact.q_s);
  EXPECT_LT((signature.X_SL[6].R - X_Sn.R).norm(), 1e-14);
  EXPECT_LT((signature.X_SL[6].p - X_Sn.p).norm(), 1e-14);
  EXPECT_EQ(signature.X_SL[0].p, exact.X_S0.p);
}

TEST(SignatureOf, predicts_targets_on_any_link_to_a_tenth_of_a_picometre_per_metre) {
  test::Random random(41);
  for (const test::KnownArm& known : test::known_arms()) {
    SCOPED_TRACE(known.name);
    const Pose X_S0 = random.pose(2);
    const JointVector q_s = random.readings(known, 3, 0.5);
    const std::size_t n = q_s.size();
    // One target near the arm on each link, written in that link's Denavit-Hartenberg frame.
    std::array<KnownTarget, kMaxFrames> targets;
    for (std::size_t k = 0; k <= n; ++k) {
      const auto X_SF = test::dh_pose(known.joints, q_s, k, X_S0);
      const test::LongVector3 near_base = (X_S0.p + Vector3(0.2, 0.3, 0.4)).cast<test::Long>();
      targets[k] = {static_cast<int>(k), k, (X_SF.inverse() * near_base).cast<double>()};
    }
    const Signature signature = signature_of(known, q_s, X_S0, std::span(targets).first(n + 1));
    for (int trial = 0; trial < 20; ++trial) {
      const JointVector q = random.readings(known, 3, 0.5);
      for (std::size_t k = 0; k <= n; ++k) {
        const test::LongVector3 truth = test::dh_pose(known.joints, q, k, X_S0) *
                                        test::LongVector3(targets[k].p_F.cast<test::Long>());
        const Vector3 predicted = kinematics::target_position(signature, q, signature.targets[k]);
        EXPECT_LT((predicted - truth.cast<double>()).norm(), 3e-13) << k;
      }
    }
  }
}

TEST(SignatureOf, traps_on_a_target_beyond_the_last_link) {
  const KnownTarget target{1, 7, Vector3::Zero()};
  EXPECT_DEATH((void)signature_of(test::puma560(), JointVector(6), Pose{}, std::span(&target, 1)),
               "");
}

}  // namespace
}  // namespace armsig
