// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "firmware/analysis/postures/cold_start.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/not_finite.hpp"
#include "host_tests/support/pose_difference.hpp"

namespace armsig::kinematics {
namespace {

using test::kInfinity;

TEST(ColdStart, finds_all_eight_named_solutions_of_an_identified_puma) {
  std::mt19937_64 random(2);
  const test::KnownArm arm = test::perturbed_puma(random);
  const Chain chain = make_chain(arm.joints, arm.limits);
  const Pose X = *forward(chain, {0.2, -0.8, 0.9, 0.3, 0.7, -0.4});
  const Solutions solutions = *cold_start(chain, closed_form(chain), X);
  ASSERT_EQ(solutions.size(), 8U);
  std::set<std::string> names;
  for (const NamedSolution& s : solutions) {
    names.insert(name(s));
    EXPECT_LT(test::pose_difference(*forward(chain, s.solution.q), X), 1e-9);
  }
  EXPECT_EQ(names.size(), 8U);
  EXPECT_TRUE(names.contains("lefty above noflip"));
}

TEST(ColdStart, lists_solutions_inside_the_limits_first) {
  const test::KnownArm arm = test::puma560();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const Pose X = *forward(chain, {0.2, -0.8, 0.9, 0.3, 0.7, -0.4});
  const Solutions solutions = *cold_start(chain, closed_form(chain), X);
  bool outside = false;
  for (const NamedSolution& s : solutions) {
    if (s.solution.verdict == Verdict::kJointLimit) outside = true;
    if (!outside) {
      for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_GE(s.solution.q[i], arm.limits[i].lower);
        EXPECT_LE(s.solution.q[i], arm.limits[i].upper);
      }
    }
    EXPECT_EQ(s.solution.verdict == Verdict::kJointLimit, outside);
  }
  EXPECT_NE(solutions[0].solution.verdict, Verdict::kJointLimit);
}

TEST(ColdStart, puts_the_solution_nearest_to_the_reference_first) {
  const test::KnownArm arm = test::ur10e_individual_a();
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector q{0.4, -1.2, 5.0, -4.5, 2.0, -5.5};
  const Solutions solutions = *cold_start(chain, closed_form(chain), *forward(chain, q), q);
  ASSERT_FALSE(solutions.empty());
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(solutions[0].solution.q[i], q[i], 1e-7);
}

// A cable allows the last joint one window of a turn: what is commanded must lie in it.
TEST(ColdStart, turns_a_joint_by_whole_turns_into_its_limits) {
  const test::KnownArm arm = test::puma560();
  const JointVector q{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};
  for (const int turns : {-3, -2, -1, 0, 1, 2, 3}) {
    JointVector turned = q;
    turned[5] += turns * 2 * kPi;
    auto limits = arm.limits;
    limits[5] = {turned[5] - radians(20), turned[5] + radians(10)};
    const Chain chain = make_chain(arm.joints, limits);
    for (const JointVector& reference : {q, JointVector{}}) {
      int found = 0;
      const Solutions solutions =
          *cold_start(chain, closed_form(chain), *forward(chain, q), reference);
      for (const NamedSolution& s : solutions) {
        double change = 0;
        for (std::size_t i = 0; i < 6; ++i) {
          change = std::max(change, std::abs(s.solution.q[i] - turned[i]));
        }
        if (change < 1e-7 && s.solution.verdict == Verdict::kConverged) ++found;
      }
      EXPECT_EQ(found, 1) << turns;
    }
  }
}

TEST(ColdStart, of_many_turns_inside_the_limits_takes_the_one_nearest_to_the_reference) {
  const test::KnownArm arm = test::puma560();
  JointVector q{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};
  auto limits = arm.limits;
  limits[5] = {-30, 30};
  const Chain chain = make_chain(arm.joints, limits);
  for (const double reading : {-25.0, -7.0, 0.0, 4.0, 19.0}) {
    q[5] = reading;
    const Solutions solutions = *cold_start(chain, closed_form(chain), *forward(chain, q), q);
    ASSERT_FALSE(solutions.empty());
    EXPECT_NEAR(solutions[0].solution.q[5], reading, 1e-7);
  }
}

TEST(ColdStart, finds_a_solution_for_arms_without_a_closed_form) {
  std::mt19937_64 random(3);
  for (const test::KnownArm& arm : {test::stanford(), test::cobra600(), test::iiwa7()}) {
    const Chain chain = make_chain(arm.joints, arm.limits);
    for (int k = 0; k < 20; ++k) {
      const Pose X = *forward(chain, test::random_readings(arm, random));
      const Solutions solutions = *cold_start(chain, closed_form(chain), X);
      ASSERT_FALSE(solutions.empty()) << arm.name;
      EXPECT_STREQ(name(solutions[0]), "solution");
      EXPECT_LT(test::pose_difference(*forward(chain, solutions[0].solution.q), X), 1e-9)
          << arm.name;
    }
  }
}

// A redundant arm as nobody builds one; to this pose of it one start in more than a hundred leads.
TEST(ColdStart, finds_a_solution_of_a_slide_between_two_wrists) {
  const auto turns = [](double d_m, double a_m, double alpha_rad) {
    return DhJoint{.d_m = d_m, .a_m = a_m, .alpha_rad = alpha_rad};
  };
  test::KnownArm arm;
  for (const DhJoint& joint :
       {turns(0.15, 0, kPi), turns(0.38, 0.4, kPi / 2), turns(0, 0.0255, kPi),
        turns(0.15, 0, -kPi / 2), DhJoint{JointType::kPrismatic, kPi / 2, 0, 0.0255, kPi},
        turns(0.15, 0, kPi / 2), turns(0.15, 0.0255, 0)}) {
    arm.joints.push_back(joint);
    const bool slides = joint.type == JointType::kPrismatic;
    arm.limits.push_back(slides ? JointLimits{0, 0.4} : JointLimits{-2.6, 2.6});
  }
  const Chain chain = make_chain(arm.joints, arm.limits);
  const JointVector q{-0.847047, 0.825526, -0.261006, 1.639564, 0.380675, 1.597719, -0.862878};
  EXPECT_FALSE(cold_start(chain, closed_form(chain), *forward(chain, q))->empty());
}

// The other elbow of a SCARA whose axes are not quite parallel reaches the position alone.
TEST(ColdStart, puts_a_solution_that_meets_the_whole_pose_before_one_that_meets_the_position) {
  test::KnownArm arm = test::cobra600();
  arm.joints[0].alpha_rad += 0.002;
  arm.joints[1].alpha_rad -= 0.003;
  const Chain chain = make_chain(arm.joints, arm.limits);
  std::mt19937_64 random(4);
  int alternatives = 0;
  for (int k = 0; k < 20; ++k) {
    const Pose X = *forward(chain, test::random_readings(arm, random));
    const Solutions solutions = *cold_start(chain, closed_form(chain), X);
    ASSERT_FALSE(solutions.empty());
    EXPECT_LT(solutions[0].solution.rotation_error_rad, 1e-9);
    alternatives += solutions.size() > 1 ? 1 : 0;
  }
  EXPECT_GT(alternatives, 5);
}

TEST(ColdStart, is_empty_where_nothing_reaches) {
  const Chain chain = make_chain(test::puma560().joints);
  Pose X = *forward(chain, {0.2, -0.8, 0.9, 0.3, 0.7, -0.4});
  X.p *= 5;
  EXPECT_TRUE(cold_start(chain, closed_form(chain), X)->empty());
}

// A joint that turns without end, or a rail of any length: looked for within a turn, or an arm's
// length.
TEST(ColdStart, finds_solutions_of_joints_without_limits) {
  std::mt19937_64 random(5);
  for (const test::KnownArm& arm : {test::puma560(), test::cobra600(), test::iiwa7()}) {
    FixedVector<JointLimits, kMaxJoints> limits(arm.joints.size(), {-kInfinity, kInfinity});
    limits[0].lower = -1;
    limits[2].upper = 3;
    const Chain chain = make_chain(arm.joints, limits);
    const ClosedForm form = closed_form(chain);
    for (int k = 0; k < 5; ++k) {
      JointVector q = test::random_readings(arm, random);
      q[0] = std::abs(q[0]);
      const Pose X = *forward(chain, q);
      const auto solutions = cold_start(chain, form, X);
      ASSERT_TRUE(solutions.has_value()) << arm.name;
      ASSERT_FALSE(solutions->empty()) << arm.name;
      const InverseSolution& first = (*solutions)[0].solution;
      EXPECT_NE(first.verdict, Verdict::kJointLimit) << arm.name;
      EXPECT_LT(test::pose_difference(*forward(chain, first.q), X), 1e-9) << arm.name;
    }
  }
}

TEST(ColdStart, refuses_a_target_that_is_not_a_rotation) {
  const Chain chain = make_chain(test::puma560().joints);
  Pose X;
  X.p = {0.4, 0.2, 0.1};
  for (const ClosedForm& form : {closed_form(chain), ClosedForm{}}) {
    for (const double factor : {0.0, 2.0, -1.0}) {
      X.R = factor * Matrix3::Identity();
      const auto solutions = cold_start(chain, form, X);
      ASSERT_FALSE(solutions.has_value());
      EXPECT_EQ(test::failure_of(solutions), Error::kNotARotation);
    }
  }
}

TEST(ColdStart, lists_no_solution_that_misses_the_pose) {
  std::mt19937_64 random(6);
  for (const test::KnownArm& arm : {test::puma560(), test::ur5()}) {
    const Chain chain = make_chain(arm.joints);
    const ClosedForm form = closed_form(chain);
    for (int k = 0; k < 100; ++k) {
      const JointVector q = test::random_readings(arm, random);
      Pose X = *forward(chain, q);
      X.R = X.R * rotation_about(Vector3::Unit(k % 3), kPi);
      const auto solutions = cold_start(chain, form, X, q);
      ASSERT_TRUE(solutions.has_value());
      for (const NamedSolution& s : *solutions) {
        EXPECT_LT(test::pose_difference(*forward(chain, s.solution.q), X), 1e-9) << arm.name;
      }
    }
  }
}

TEST(ColdStart, refuses_a_pose_that_is_not_finite) {
  const Chain chain = make_chain(test::puma560().joints);
  Pose X;
  X.p.x() = kInfinity;
  for (const ClosedForm& form : {closed_form(chain), ClosedForm{}}) {
    EXPECT_EQ(test::failure_of(cold_start(chain, form, X)), Error::kNotFinite);
  }
}

// The middle of all angles is zero.
TEST(ColdStart, of_a_joint_without_limits_takes_the_reading_nearest_to_zero) {
  const Chain chain =
      make_chain(DhRows{{JointType::kRevolute, 0, 0, 0.5, 0}}, {{-kInfinity, kInfinity}});
  for (const double reading : {-3.0, 0.4, 3.0}) {
    const Solutions solutions = *cold_start(chain, closed_form(chain), *forward(chain, {reading}));
    ASSERT_EQ(solutions.size(), 1U);
    EXPECT_NEAR(solutions[0].solution.q[0], reading, 1e-9);
  }
}

// The middle of the turn that begins at -1 is 2.14: 1.8 is nearer to it than 1.2, where the other
// elbow is.
TEST(ColdStart, of_a_joint_with_one_limit_begins_at_the_middle_of_a_turn_from_it) {
  const DhJoint link{JointType::kRevolute, 0, 0, 0.5, 0};
  const Chain chain = make_chain(DhRows{link, link, link}, {{-1, kInfinity}, {-3, 3}, {-3, 3}});
  const Pose X = *forward(chain, {1.2, 0.6, -0.3});
  const Solutions solutions = *cold_start(chain, closed_form(chain), X);
  ASSERT_EQ(solutions.size(), 2U);
  EXPECT_NEAR(solutions[0].solution.q[0], 1.8, 1e-7);
  EXPECT_NEAR(solutions[1].solution.q[0], 1.2, 1e-7);
}

}  // namespace
}  // namespace armsig::kinematics
