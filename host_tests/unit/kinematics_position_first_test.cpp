// SPDX-License-Identifier: MIT
// Arms of three to five joints meet a position, and an orientation as near as that leaves them:
// judged by the null space of a singular value decomposition.
#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "core/kinematics/inverse.hpp"
#include "core/kinematics/position_first.hpp"
#include "core/kinematics/regularity.hpp"
#include "firmware/analysis/postures/cold_start.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/ready_puma.hpp"
#include "host_tests/support/short_arms.hpp"

namespace armsig::kinematics {
namespace {

using test::ShortArm;

// Rows of the Jacobian at the tool, for the position and the orientation, and the motions of the
// joints that leave the position.
struct AtTool {
  Eigen::MatrixXd A;
  Eigen::MatrixXd B;
  Eigen::MatrixXd N;
  Eigen::VectorXd singular_values;
  Pose X_0n;

  AtTool(const Chain& chain, const JointVector& q, const Vector3& p_nT) {
    const PoseAndJacobian at = *forward_with_jacobian(chain, q);
    X_0n = at.X_0n;
    const auto n = static_cast<Eigen::Index>(chain.joint_count);
    A = at.J.topLeftCorner(3, n);
    B = at.J.bottomLeftCorner(3, n);
    for (Eigen::Index i = 0; i < n; ++i) A.col(i) += Vector3(B.col(i)).cross(X_0n.R * p_nT);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
    N = svd.matrixV().rightCols(n - 3);
    singular_values = svd.singularValues();
  }
};

// The tool on its way from arm.at, turned as it is there.
Pose on_the_way(const ShortArm& arm, const Chain& chain, double part) {
  const Pose X_0n = *forward(chain, arm.at);
  return {X_0n.R, X_0n.p + part * arm.way};
}

// Both as drawn and as built, by seeds.
template <typename F>
void with_each_arm(const F& judge) {
  std::mt19937_64 random(36);
  for (const ShortArm& arm : test::short_arms()) {
    judge(arm, arm.arm);
    for (int k = 0; k < 20; ++k) judge(arm, test::individual(arm.arm, random));
  }
}

TEST(PositionFirst, is_the_task_of_three_to_five_joints_that_move_the_tip_in_all_directions) {
  with_each_arm([](const ShortArm& arm, const test::KnownArm& built) {
    EXPECT_TRUE(make_chain(built.joints).position_first) << arm.arm.name;
  });
  EXPECT_FALSE(make_chain(test::puma560().joints).position_first);
  EXPECT_FALSE(make_chain(test::iiwa7().joints).position_first);
  EXPECT_FALSE(make_chain(test::puma_rows(2)).position_first);
}

// Three parallel axes: out of parallel, they lift the tip by hundredths of what they move it.
TEST(PositionFirst, is_not_the_task_of_joints_that_move_the_tip_in_a_plane_but_for_their_errors) {
  std::mt19937_64 random(5);
  const DhJoint link{JointType::kRevolute, 0, 0, 0.4, 0};
  test::KnownArm planar;
  planar.joints = {link, link, link};
  EXPECT_FALSE(make_chain(planar.joints).position_first);
  for (int k = 0; k < 100; ++k) {
    EXPECT_FALSE(make_chain(test::individual(planar, random).joints).position_first);
  }
}

TEST(PositionFirst, position_is_met_and_no_motion_that_leaves_it_turns_nearer) {
  with_each_arm([](const ShortArm& arm, const test::KnownArm& built) {
    const Chain chain = make_chain(built.joints, arm.arm.limits);
    JointVector q = arm.at;
    for (int k = 1; k <= 20; ++k) {
      const Pose X = on_the_way(arm, chain, k / 20.0);
      const auto found = inverse(chain, X, q, {.p_nP = arm.p_nT});
      ASSERT_TRUE(found);
      ASSERT_EQ(found->verdict, Verdict::kConverged) << built.name << " " << k;
      q = found->q;
      const AtTool at(chain, q, arm.p_nT);
      EXPECT_LT((at.X_0n * arm.p_nT - X * arm.p_nT).norm(), 1e-9) << built.name;
      const Vector3 turn = rotation_vector(X.R * at.X_0n.R.transpose());
      EXPECT_NEAR(found->rotation_error_rad, turn.norm(), 1e-9);
      EXPECT_LT((at.N.transpose() * (at.B.transpose() * turn)).norm(), 1e-7) << built.name;
    }
  });
}

TEST(PositionFirst, as_drawn_meets_the_whole_pose_where_the_joints_can) {
  for (const ShortArm& arm : test::short_arms()) {
    if (arm.arm.name != "cobra600" && arm.arm.name != "gantry") continue;
    const Chain chain = make_chain(arm.arm.joints, arm.arm.limits);
    const auto found = inverse(chain, on_the_way(arm, chain, 0.5), arm.at, {.p_nP = arm.p_nT});
    EXPECT_LT(found->rotation_error_rad, 1e-9) << arm.arm.name;
  }
}

// A tick has twelve passes, and moves by less than this.
TEST(PositionFirst, takes_few_passes_from_a_hundredth_of_the_line_away) {
  with_each_arm([](const ShortArm& arm, const test::KnownArm& built) {
    const Chain chain = make_chain(built.joints, arm.arm.limits);
    JointVector q = arm.at;
    for (int k = 1; k <= 100; ++k) {
      const auto found = inverse(chain, on_the_way(arm, chain, k / 100.0), q, {.p_nP = arm.p_nT});
      ASSERT_LE(found->iterations, 12) << built.name;
      q = found->q;
    }
  });
}

TEST(PositionFirst, regularity_is_the_volume_of_the_position_times_that_of_the_turns_left) {
  std::mt19937_64 random(8);
  for (const ShortArm& arm : test::short_arms()) {
    const test::KnownArm built = test::individual(arm.arm, random);
    Chain chain = make_chain(built.joints);
    chain.length = 1;  // rad and m alike
    const auto solution = inverse(chain, *forward(chain, arm.at), arm.at, {.p_nP = arm.p_nT});
    const AtTool at(chain, arm.at, arm.p_nT);
    const Eigen::MatrixXd turns = at.B * at.N;
    const double expected =
        at.singular_values.prod() * std::sqrt((turns.transpose() * turns).determinant());
    EXPECT_GT(expected, 1e-3) << built.name;
    EXPECT_NEAR(solution->regularity, expected, 1e-9 * expected) << built.name;
  }
}

// A straight elbow turns the tool in no way, but it can't bring it nearer.
TEST(PositionFirst, regularity_is_zero_where_the_position_alone_is_singular) {
  const test::KnownArm arm = test::first_joints(test::shared("../cases/kinematics/five_axes"), 3);
  const Chain chain = make_chain(arm.joints);
  EXPECT_GT(regularity(chain, *forward_with_jacobian(chain, {0.1, 0.4, -1.0})), 0.1);
  EXPECT_LT(regularity(chain, *forward_with_jacobian(chain, {0.1, 0.4, 0.0})), 1e-6);
}

// The axes out of parallel would make up for the slide by turning the elbow round.
TEST(PositionFirst, slide_at_its_limit_is_no_reason_to_turn_the_elbow_round) {
  std::mt19937_64 random(9);
  for (int k = 0; k < 50; ++k) {
    const test::KnownArm arm = test::individual(test::cobra600(), random);
    const Chain chain = make_chain(arm.joints, arm.limits);
    for (const bool up : {false, true}) {
      JointVector q{0.2, radians(60), up ? arm.limits[2].upper : arm.limits[2].lower, 0.3};
      Pose X = *forward(chain, q);
      X.p += (up ? 1e-3 : -1e-3) * X.R.col(2);
      const auto found = inverse(chain, X, q, {.p_nP = {0.06, 0, 0.08}});
      EXPECT_EQ(found->verdict, Verdict::kJointLimit);
      EXPECT_LT(largest_change(found->q, q), 0.01);
    }
  }
}

// A joint that the orientation asks beyond its limit stays there, and the tool where it shall be.
TEST(PositionFirst, hand_at_its_limit_turns_no_further_and_stays_in_its_place) {
  std::mt19937_64 random(10);
  for (int k = 0; k < 50; ++k) {
    test::KnownArm arm = test::individual(test::cobra600(), random);
    const JointVector q{0.2, radians(60), 0.1, 0.3};
    arm.limits[3] = {-1, q[3]};
    const Chain chain = make_chain(arm.joints, arm.limits);
    for (const double sense : {1.0, -1.0}) {
      Pose turned = *forward(chain, q);
      turned.R = rotation_z(sense * 0.2) * turned.R;
      const auto found = inverse(chain, turned, q);
      ASSERT_EQ(found->verdict, Verdict::kConverged);
      EXPECT_LE(found->q[3], q[3]);
      EXPECT_LT((forward(chain, found->q)->p - turned.p).norm(), 1e-9);
    }
  }
}

// Both elbows of a SCARA reach a place; one of them with the hand turned far from what was asked.
TEST(PositionFirst, cold_start_puts_first_what_misses_the_orientation_least) {
  std::mt19937_64 random(11);
  int others = 0;
  for (int k = 0; k < 50; ++k) {
    test::KnownArm arm = test::individual(test::cobra600(), random);
    arm.limits[3] = {-0.5, 0.5};
    const Chain chain = make_chain(arm.joints, arm.limits);
    const JointVector q{0.2, radians(60), 0.1, 0.3};
    Pose X = *forward(chain, q);
    X.R = X.R * rotation_x(0.003);  // no reading meets it
    const JointVector at_the_other{0.9, radians(-60), 0.1, -0.4};
    const auto found = cold_start(chain, {}, X, at_the_other);
    ASSERT_TRUE(found && !found->empty());
    EXPECT_LT(largest_change((*found)[0].solution.q, q), 0.05);
    others += found->size() > 1 ? 1 : 0;
  }
  EXPECT_GT(others, 25);
}

}  // namespace
}  // namespace armsig::kinematics
