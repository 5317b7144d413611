// SPDX-License-Identifier: MIT
#include "core/pseudo_dh/pseudo_dh.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::pseudo_dh {
namespace {

using test::kP;
using test::kR;

// Two rows whose sums are easy to do in the head: (beta, d, a, alpha, gamma, b).
FixedVector<s_model::Parameters, kMaxJoints> two_rows() {
  return {{0.5, 1, 10, 0.1, 0.25, 2}, {0.75, 4, 20, 0.2, 1.5, 8}};
}

TEST(PseudoDh, a_and_alpha_are_those_of_the_s_model) {  // (11), (12)
  const auto rows = from_s_model(two_rows(), {kR, kR}, {0.0, 0.0});
  EXPECT_EQ(rows[0].a_m, 10);
  EXPECT_EQ(rows[0].alpha_rad, 0.1);
  EXPECT_EQ(rows[1].a_m, 20);
  EXPECT_EQ(rows[1].alpha_rad, 0.2);
}

TEST(PseudoDh, theta_adds_gamma_of_the_row_before) {  // (9)
  EXPECT_EQ(from_s_model(two_rows(), {kR, kR}, {0.0, 0.0})[1].theta_rad, 0.75 + 0.25);
}

TEST(PseudoDh, d_adds_b_of_the_row_before) {  // (10)
  EXPECT_EQ(from_s_model(two_rows(), {kR, kR}, {0.0, 0.0})[1].d_m, 4 + 2);
}

TEST(PseudoDh, first_row_has_no_row_before_it) {  // (22), (23)
  const auto rows = from_s_model(two_rows(), {kR, kR}, {0.0, 0.0});
  EXPECT_EQ(rows[0].theta_rad, 0.5);
  EXPECT_EQ(rows[0].d_m, 1);
}

TEST(PseudoDh, revolute_offset_is_what_theta_lacks_to_the_reading) {  // (19)
  const auto rows = from_s_model(two_rows(), {kR, kR}, {0.25, -0.5});
  EXPECT_EQ(rows[0].theta_rad, 0.25);
  EXPECT_EQ(rows[1].theta_rad, 1.5);
  EXPECT_EQ(rows[1].d_m, 6);
}

TEST(PseudoDh, prismatic_offset_is_what_d_lacks_to_the_reading) {  // (19), (23)
  const auto rows = from_s_model(two_rows(), {kP, kP}, {0.25, -0.5});
  EXPECT_EQ(rows[0].d_m, 0.75);
  EXPECT_EQ(rows[0].theta_rad, 0.5);
  EXPECT_EQ(rows[1].d_m, 6.5);
  EXPECT_EQ(rows[1].theta_rad, 1.0);
}

TEST(PseudoDh, offset_of_a_joint_many_turns_from_zero_is_within_a_turn) {
  const auto rows = from_s_model(two_rows(), {kR, kR}, {200 * kPi, 0.0});
  EXPECT_NEAR(rows[0].theta_rad, 0.5, 1e-12);
}

TEST(PseudoDh, product_and_last_frame_give_the_s_model_product_at_the_signature_configuration) {
  test::Random random(21);
  FixedVector<s_model::Parameters, kMaxJoints> s;
  JointTypes types;
  JointVector q;
  Pose S;
  for (std::size_t i = 0; i < kMaxJoints; ++i) {
    s.push_back({random.uniform(-3, 3), random.uniform(-1, 1), random.uniform(-1, 1),
                 random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-1, 1)});
    types.push_back(i % 3 == 2 ? kP : kR);
    q.push_back(random.uniform(-1, 1));
    S = S * s_model::to_transform(s[i]);  // (3)
  }
  const auto rows = from_s_model(s, types, q);
  const Pose T =
      test::rounded(test::dh_pose(rows, q, kMaxJoints, Pose{})) * link_frame_in_dh_frame(s[7]);
  EXPECT_LT((T.R - S.R).norm(), 1e-14);
  EXPECT_LT((T.p - S.p).norm(), 1e-14);
}

TEST(PseudoDh, traps_when_counts_differ) {
  EXPECT_DEATH((void)from_s_model(two_rows(), {kR}, {0.0, 0.0}), "");
  EXPECT_DEATH((void)from_s_model(two_rows(), {kR, kR}, {0.0}), "");
}

}  // namespace
}  // namespace armsig::pseudo_dh
