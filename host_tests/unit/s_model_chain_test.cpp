// SPDX-License-Identifier: MIT
#include "core/kinematics/s_model_chain.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "host_tests/support/exact_arm.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::kinematics {
namespace {

TEST(SModelChain, stands_as_identified_at_the_signature_configuration) {
  const JointVector q_s{0.3, -0.4, 0.9, 0.2, -0.7, 0.1};
  const Signature signature =
      signature_of(test::puma560_robot1(), q_s, Pose{rotation_x(0.4), {1, 2, 3}}, {});
  for (std::size_t k = 0; k <= 6; ++k) {
    EXPECT_LT((link_pose(signature, q_s, k).p - signature.X_SL[k].p).norm(), 1e-14);
    EXPECT_LT((link_pose(signature, q_s, k).R - signature.X_SL[k].R).norm(), 1e-14);
  }
}

TEST(SModelChain, link_zero_does_not_move) {
  const Signature signature = signature_of(test::puma560(), JointVector(6, 0.1), Pose{}, {});
  EXPECT_EQ(link_pose(signature, JointVector(6, 2.0), 0).p, signature.X_SL[0].p);
}

TEST(SModelChain, prismatic_joint_moves_its_link_along_the_axis) {
  const JointVector q_s{0.3, -0.4, 0.5, 0.2, -0.7, 0.1};
  const Signature signature = signature_of(test::stanford(), q_s, Pose{}, {});
  JointVector q = q_s;
  q[2] += 0.25;
  const Vector3 travel = link_pose(signature, q, 6).p - signature.X_SL[6].p;
  EXPECT_LT((travel - 0.25 * signature.X_SL[2].R.col(2)).norm(), 1e-15);
}

TEST(SModelChain, target_moves_with_its_own_link_and_not_with_the_next) {
  const KnownTarget on_link_2{7, 2, Vector3(-0.1, 0.05, 0.02)};
  const JointVector q_s(6, 0.1);
  const Signature signature = signature_of(test::puma560(), q_s, Pose{}, std::span(&on_link_2, 1));
  JointVector q = q_s;
  q[2] += 1.0;
  EXPECT_LT((target_position(signature, q, signature.targets[0]) - signature.targets[0].p_S).norm(),
            1e-15);
  q[1] += 1.0;
  EXPECT_GT((target_position(signature, q, signature.targets[0]) - signature.targets[0].p_S).norm(),
            0.1);
}

TEST(SModelChain, in_single_precision_is_within_five_micrometres_on_every_arm) {
  test::Random random(51);
  std::mt19937_64 readings(52);
  double longest_d_m = 0;
  for (const test::KnownArm& arm : test::known_arms()) {
    for (const DhJoint& row : arm.joints) longest_d_m = std::max(longest_d_m, std::abs(row.d_m));
    const JointVector q_s = test::random_readings(arm, readings);
    const Signature signature = signature_of(arm, q_s, random.pose(2), {});
    const SModelChain<float> chain = chain_of<float>(signature);
    const SModelChain<double> in_double = chain_of<double>(signature);
    double worst_m = 0;
    for (int i = 0; i < 2000; ++i) {
      const JointVector q = test::random_readings(arm, readings);
      const Vector3 p = link_pose(chain, q, q.size()).p.cast<double>();
      worst_m = std::max(worst_m, (p - link_pose(in_double, q, q.size()).p).norm());
    }
    EXPECT_LT(worst_m, 5e-6) << arm.name;
  }
  EXPECT_GT(longest_d_m, 100);
}

TEST(SModelChain, traps_on_a_link_beyond_the_last_and_on_missing_readings) {
  const Signature signature = signature_of(test::puma560(), JointVector(6), Pose{}, {});
  EXPECT_DEATH((void)link_pose(signature, JointVector(6), 7), "");
  EXPECT_DEATH((void)link_pose(signature, JointVector(5), 3), "");
}

}  // namespace
}  // namespace armsig::kinematics
