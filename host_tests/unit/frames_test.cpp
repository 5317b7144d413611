// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "core/frames/axis_lines.hpp"
#include "core/frames/link_frames.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::frames {
namespace {

using test::kP;
using test::kR;

features::JointFeature circle(const Vector3& axis, const Vector3& centre, const Vector3& radial) {
  features::JointFeature feature;
  feature.axis_S = axis;
  feature.point_S = centre;
  feature.radial_S = radial;
  feature.radius_m = 0.3;
  return feature;
}

features::JointFeature line(const Vector3& axis, const Vector3& point, double reading) {
  features::JointFeature feature;
  feature.type = kP;
  feature.axis_S = axis;
  feature.point_S = point;
  feature.reference_reading = reading;
  return feature;
}

TEST(LinkFrames, revolute_frame_stands_at_the_centre_with_x_to_the_first_point) {  // (16), (17)
  const auto X_SL = link_frames({circle(Vector3::UnitY(), {1, 2, 3}, Vector3::UnitZ())}, {0.4});
  EXPECT_EQ(X_SL[0].R.col(0), Vector3::UnitZ());
  EXPECT_EQ(X_SL[0].R.col(1), Vector3::UnitX());
  EXPECT_EQ(X_SL[0].R.col(2), Vector3::UnitY());
  EXPECT_EQ(X_SL[0].p, Vector3(1, 2, 3));
}

TEST(LinkFrames, prismatic_frame_stands_where_the_target_is_at_the_signature_reading) {
  const auto X_SL = link_frames({line(Vector3::UnitX(), {1, 2, 3}, 0.1)}, {0.35});
  EXPECT_TRUE(X_SL[0].p.isApprox(Vector3(1.25, 2, 3), 1e-15));
  EXPECT_EQ(X_SL[0].R.col(2), Vector3::UnitX());
  EXPECT_TRUE(X_SL[0].R.isUnitary(1e-15));
}

TEST(LinkFrames, last_frame_is_the_one_before) {
  const auto X_SL = link_frames({circle(Vector3::UnitY(), {1, 2, 3}, Vector3::UnitZ()),
                                 line(Vector3::UnitX(), {1, 2, 3}, 0.1)},
                                {0.0, 0.0});
  ASSERT_EQ(X_SL.size(), 3U);
  EXPECT_EQ(X_SL[2].R, X_SL[1].R);
  EXPECT_EQ(X_SL[2].p, X_SL[1].p);
}

TEST(LinkFrames, are_orthonormal_although_the_feature_is_a_little_off) {
  const auto X_SL = link_frames({circle({0.3, 0.5, 0.8}, {1, 2, 3}, {0.9, -0.2, 0.1})}, {0.0});
  EXPECT_TRUE((X_SL[0].R.transpose() * X_SL[0].R).isIdentity(1e-15));
  EXPECT_NEAR(X_SL[0].R.determinant(), 1, 1e-15);
  EXPECT_LT(X_SL[0].R.col(2).cross(Vector3(0.3, 0.5, 0.8)).norm(), 1e-15);
}

TEST(LinkFrames, radial_along_the_axis_is_replaced_by_a_perpendicular) {
  const auto X_SL = link_frames({circle(Vector3::UnitZ(), {0, 0, 0}, Vector3::UnitZ())}, {0.0});
  EXPECT_TRUE((X_SL[0].R.transpose() * X_SL[0].R).isIdentity(1e-15));
}

TEST(LinkFrames, trap_without_a_feature_or_a_reading) {
  EXPECT_DEATH((void)link_frames(FixedVector<features::JointFeature, kMaxJoints>{}, {}), "");
  EXPECT_DEATH((void)link_frames({line(Vector3::UnitX(), {1, 2, 3}, 0.1)}, {}), "");
}

TEST(KnownLinkFrames, frame_slid_back_along_its_axis_is_the_denavit_hartenberg_frame) {
  test::Random random(31);
  for (const test::KnownArm& known : test::known_arms()) {
    const JointVector q = random.readings(known, 3, 0.5);
    const KnownLinkFrames frames = link_frames(known.joints, q);
    for (std::size_t k = 0; k < frames.X_0L.size(); ++k) {
      const Pose X_0F = test::rounded(test::dh_pose(known.joints, q, k, Pose{}));
      EXPECT_LT((frames.X_0L[k].R - X_0F.R).norm(), 1e-14) << known.name << k;
      const Vector3 slid = X_0F.p + frames.along_m[k] * X_0F.R.col(2);
      EXPECT_LT((frames.X_0L[k].p - slid).norm(), 1e-12) << known.name << k;
    }
  }
}

TEST(KnownLinkFrames, first_is_the_base_and_last_the_arms_own) {
  const KnownLinkFrames frames = link_frames(test::ur10e_individual_a().joints, JointVector(6));
  EXPECT_TRUE(frames.X_0L[0].R.isIdentity(0));
  EXPECT_EQ(frames.X_0L[0].p, Vector3::Zero());
  EXPECT_EQ(frames.along_m[6], 0.0);
}

TEST(KnownLinkFrames, stay_near_an_arm_whose_origins_are_hundreds_of_metres_away) {
  const KnownLinkFrames frames = link_frames(test::ur10e_individual_a().joints, JointVector(6));
  for (const Pose& X_0L : frames.X_0L) EXPECT_LT(X_0L.p.norm(), 2.0);
  EXPECT_GT(std::abs(frames.along_m[2]), 300.0);
}

TEST(AxisLines, of_a_drawing_pass_through_its_denavit_hartenberg_origins) {
  const JointVector q{0.3, -0.4, 0.9, 0.2, -0.7, 0.1};
  const AxisLines lines = axis_lines(test::puma560(), q);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Pose X_0F = test::rounded(test::dh_pose(test::puma560().joints, q, i, Pose{}));
    EXPECT_LT((lines[i].direction - X_0F.R.col(2)).norm(), 1e-15) << i;
    EXPECT_LT(lines[i].direction.cross(lines[i].point - X_0F.p).norm(), 1e-15) << i;
  }
}

TEST(AxisLines, carry_points_near_the_arm_wherever_the_frames_stand) {
  Signature near_arm;
  near_arm.types = {kR, kR, kR};
  near_arm.X_SL = {Pose{}, Pose{rotation_x(-kPi / 2), {0, 0.1, 0.3}},
                   Pose{rotation_x(-kPi / 2), {0.4, 0.2, 0.3}}, Pose{}};
  Signature far = near_arm;
  for (Pose& X_SL : far.X_SL) X_SL.p += 7.0 * X_SL.R.col(2);
  const AxisLines expected = axis_lines(near_arm);
  const AxisLines lines = axis_lines(far);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT((lines[i].point - expected[i].point).norm(), 0.3) << i;
    EXPECT_LT(lines[i].direction.cross(lines[i].point - expected[i].point).norm(), 1e-14) << i;
  }
}

TEST(ArmSize, is_the_reach_between_axes) {
  const AxisLines lines{{kR, Vector3::UnitZ(), {0, 0, 0}}, {kR, Vector3::UnitZ(), {3, 4, 0}}};
  EXPECT_EQ(arm_size(lines), 5.0);
}

TEST(ArmSize, of_a_wrist_is_a_decimetre) {
  const AxisLines lines{{kR, Vector3::UnitZ(), {0, 0, 0}}, {kR, Vector3::UnitX(), {0, 0, 0}}};
  EXPECT_EQ(arm_size(lines), 0.1);
}

TEST(ArmSize, leaves_prismatic_joints_out) {
  const AxisLines lines{{kR, Vector3::UnitZ(), {0, 0, 0}}, {kP, Vector3::UnitX(), {9, 9, 9}}};
  EXPECT_EQ(arm_size(lines), 0.1);
}

}  // namespace
}  // namespace armsig::frames
