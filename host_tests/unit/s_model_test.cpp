// SPDX-License-Identifier: MIT
#include "core/s_model/s_model.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/exact_arm.hpp"

namespace armsig::s_model {
namespace {

void expect_same(const Pose& X, const Pose& Y, double tolerance) {
  EXPECT_LT((X.R - Y.R).norm(), tolerance);
  EXPECT_LT((X.p - Y.p).norm(), tolerance);
}

// Golden transforms: (4) multiplied out as 4 x 4 matrices with 40 digits (Python, mpmath).
Pose golden_general() {
  return {Matrix3{{-0.291690026133346116, 0.765042416104443431, 0.574131544347986069},
                  {-0.687933896356078201, 0.249245713768713174, -0.681632986593422839},
                  {-0.664577973528067296, -0.593790093997028834, 0.453596121425577388}},
          Vector3(-0.177700832572488622, -0.440979675288185952, 0.423399030356394347)};
}
Pose golden_near_parallel() {
  return {Matrix3{{-0.666276013909691988, -0.745705194744718248, -0.00018926001627574945},
                  {0.745705214694617913, -0.666276015324436017, -0.0000646579129416479295},
                  {-0.000077883667942505643, -0.000184212197572495694, 0.999999980000000067}},
          Vector3(0.547669080906417261, 0.253149823261878018, -0.374939990000200033)};
}

TEST(FromTransform, finds_the_parameters_of_a_golden_transform) {
  const Parameters s = from_transform(golden_general(), Branch::kPositiveAlpha);
  EXPECT_NEAR(s.beta_rad, 0.7, 1e-15);
  EXPECT_NEAR(s.d_m, 0.31, 1e-15);
  EXPECT_NEAR(s.a_m, -0.42, 1e-15);
  EXPECT_NEAR(s.alpha_rad, 1.1, 1e-15);
  EXPECT_NEAR(s.gamma_rad, -2.3, 1e-15);
  EXPECT_NEAR(s.b_m, 0.25, 1e-15);
}

TEST(FromTransform, other_branch_turns_half_a_turn_and_changes_signs) {
  for (const Branch branch : {Branch::kNegativeAlpha, Branch::kPositiveA}) {
    const Parameters s = from_transform(golden_general(), branch);
    EXPECT_NEAR(s.beta_rad, 0.7 - kPi, 1e-15);
    EXPECT_NEAR(s.d_m, 0.31, 1e-15);
    EXPECT_NEAR(s.a_m, 0.42, 1e-15);
    EXPECT_NEAR(s.alpha_rad, -1.1, 1e-15);
    EXPECT_NEAR(s.gamma_rad, kPi - 2.3, 1e-15);
    EXPECT_NEAR(s.b_m, 0.25, 1e-15);
  }
}

TEST(FromTransform, negative_a_is_a_branch_too) {
  EXPECT_NEAR(from_transform(golden_general(), Branch::kNegativeA).a_m, -0.42, 1e-15);
}

TEST(FromTransform, finds_a_common_normal_three_kilometres_away) {
  // eps / |sin alpha| = 1e-12 of uncertainty in beta, gamma and (relative) in b.
  const Parameters s = from_transform(golden_near_parallel(), Branch::kNegativeAlpha);
  EXPECT_NEAR(s.beta_rad, 1.9, 1e-11);
  EXPECT_NEAR(s.d_m, 3000.125, 1e-7);
  EXPECT_NEAR(s.a_m, 0.0625, 1e-11);
  EXPECT_NEAR(s.alpha_rad, -0.0002, 1e-15);
  EXPECT_NEAR(s.gamma_rad, 0.4, 1e-11);
  EXPECT_NEAR(s.b_m, -3000.5, 1e-7);
}

TEST(FromTransform, product_keeps_its_digits_although_beta_is_uncertain) {
  // Golden entries are rounded to 1e-16; b of 3,000 m rounds to 5e-13.
  const Parameters s = from_transform(golden_near_parallel(), Branch::kNegativeAlpha);
  expect_same(to_transform(s), golden_near_parallel(), 1e-12);
}

TEST(FromTransform, intersecting_axes_have_no_a) {
  const Pose B{rotation_z(0.3) * rotation_x(1.2) * rotation_z(0.4), Vector3(0, 0, 0.5)};
  const Parameters s = from_transform(B, Branch::kPositiveAlpha);
  EXPECT_NEAR(s.a_m, 0, 1e-16);
  EXPECT_NEAR(s.b_m, 0, 1e-16);
  EXPECT_NEAR(s.d_m, 0.5, 1e-16);
  EXPECT_NEAR(s.beta_rad, 0.3, 1e-15);
}

TEST(FromTransform, parallel_axes_give_alpha_zero_and_no_b) {
  const Pose B{rotation_z(0.8), Vector3(0.3, 0.4, 0.2)};
  const Parameters s = from_transform(B, Branch::kPositiveA);
  EXPECT_EQ(s.alpha_rad, 0.0);
  EXPECT_EQ(s.b_m, 0.0);
  EXPECT_NEAR(s.a_m, 0.5, 1e-16);
  EXPECT_NEAR(s.beta_rad, std::atan2(0.4, 0.3), 1e-15);
  EXPECT_NEAR(s.gamma_rad, 0.8 - std::atan2(0.4, 0.3), 1e-15);
  EXPECT_NEAR(s.d_m, 0.2, 1e-16);
  expect_same(to_transform(s), B, 1e-15);
}

TEST(FromTransform, parallel_axes_with_negative_a_are_half_a_turn_round) {
  const Pose B{rotation_z(0.8), Vector3(0.3, 0.4, 0.2)};
  const Parameters s = from_transform(B, Branch::kNegativeA);
  EXPECT_NEAR(s.a_m, -0.5, 1e-16);
  EXPECT_NEAR(s.beta_rad, std::atan2(0.4, 0.3) - kPi, 1e-15);
  expect_same(to_transform(s), B, 1e-15);
}

TEST(FromTransform, antiparallel_axes_give_alpha_pi) {
  const Pose B{rotation_z(0.8) * rotation_x(kPi) * rotation_z(-0.3), Vector3(0.3, -0.4, 0.2)};
  const Parameters s = from_transform(B, Branch::kPositiveA);
  EXPECT_EQ(s.alpha_rad, kPi);
  EXPECT_EQ(s.b_m, 0.0);
  EXPECT_NEAR(s.a_m, 0.5, 1e-16);
  expect_same(to_transform(s), B, 1e-15);
}

TEST(FromTransform, coaxial_axes_have_beta_zero) {
  for (const double alpha_rad : {0.0, kPi}) {
    const Pose B{rotation_x(alpha_rad) * rotation_z(0.6), Vector3(1e-14, -1e-14, 0.2)};
    const Parameters s = from_transform(B, Branch::kPositiveA);
    EXPECT_EQ(s.beta_rad, 0.0);
    EXPECT_EQ(s.a_m, 0.0);
    EXPECT_NEAR(s.gamma_rad, 0.6, 1e-15);
    EXPECT_NEAR(s.d_m, 0.2, 1e-16);
  }
}

TEST(FromTransform, axes_just_above_the_threshold_are_kept) {
  const Pose B{rotation_x(1.01 * kParallelSine), Vector3(0.3, 0.4, 0)};
  EXPECT_FALSE(is_parallel(from_transform(B, Branch::kPositiveA)));
}

TEST(FromTransform, axes_just_below_the_threshold_are_made_parallel) {
  for (const double alpha_rad : {0.99 * kParallelSine, kPi - 0.99 * kParallelSine}) {
    const Pose B{rotation_x(alpha_rad), Vector3(0.3, 0.4, 0)};
    EXPECT_TRUE(is_parallel(from_transform(B, Branch::kPositiveA)));
  }
}

TEST(FromTransform, snapping_tilts_the_frame_by_the_angle_between_the_axes_and_no_more) {
  const double tilt_rad = 1e-8;
  const Pose B{rotation_x(tilt_rad) * rotation_z(1.3), Vector3(0.3, 0.4, 0.1)};
  const Pose snapped = to_transform(from_transform(B, Branch::kPositiveA));
  EXPECT_NEAR(angle_between(snapped.R, B.R), tilt_rad, 1e-14);
  EXPECT_LT((snapped.p - B.p).norm(), 1e-15);
}

TEST(FromTransform, inverts_to_transform_for_random_parameters) {
  test::Random random(11);
  for (int i = 0; i < 2000; ++i) {
    const Parameters truth{random.uniform(-3, 3),  random.uniform(-1, 1), random.uniform(-1, 1),
                           random.uniform(0.1, 3), random.uniform(-3, 3), random.uniform(-1, 1)};
    const Parameters s = from_transform(to_transform(truth), Branch::kPositiveAlpha);
    EXPECT_NEAR(s.beta_rad, truth.beta_rad, 1e-14);
    EXPECT_NEAR(s.d_m, truth.d_m, 1e-13);
    EXPECT_NEAR(s.a_m, truth.a_m, 1e-14);
    EXPECT_NEAR(s.alpha_rad, truth.alpha_rad, 1e-14);
    EXPECT_NEAR(s.gamma_rad, truth.gamma_rad, 1e-14);
    EXPECT_NEAR(s.b_m, truth.b_m, 1e-13);
  }
}

TEST(BranchOf, follows_the_sign_of_the_drawn_twist) {
  EXPECT_EQ(branch_of({.alpha_rad = kPi / 2}), Branch::kPositiveAlpha);
  EXPECT_EQ(branch_of({.alpha_rad = -1.5}), Branch::kNegativeAlpha);
}

TEST(BranchOf, follows_the_sign_of_a_where_the_drawn_axes_are_parallel) {
  EXPECT_EQ(branch_of({.a_m = 0.4, .alpha_rad = 0.0}), Branch::kPositiveA);
  EXPECT_EQ(branch_of({.a_m = -0.4, .alpha_rad = kPi}), Branch::kNegativeA);
}

TEST(BranchOf, takes_a_twist_written_with_five_digits_as_parallel) {
  EXPECT_EQ(branch_of({.a_m = -0.4, .alpha_rad = 3.1416}), Branch::kNegativeA);
}

TEST(BranchOf, a_row_without_twist_and_length_is_positive) {
  EXPECT_EQ(branch_of({}), Branch::kPositiveA);
}

}  // namespace
}  // namespace armsig::s_model
