// SPDX-License-Identifier: MIT
// Every posture of a pose: against two hundred random starts each, at folds, straight wrists and
// limits.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/analysis/postures/cold_start.hpp"
#include "firmware/analysis/postures/posture_search.hpp"
#include "host_tests/support/pose_difference.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::kinematics {
namespace {

using test::kR;

struct NamedRows {
  std::string name;
  DhRows rows;
};

// Spherical wrists, three parallel axes, wrists with an offset, wrists that are not square.
std::vector<NamedRows> six_axis_arms() {
  const double q = kPi / 2;
  return {
      {"Puma",
       {{kR, 0, 0, 0, -q},
        {kR, 0, 0.149, 0.4318, 0},
        {kR, 0, 0, -0.0203, q},
        {kR, 0, 0.4307, 0, -q},
        {kR, 0, 0, 0, q},
        {kR, 0, 0, 0, 0}}},
      {"elbow with an offset",
       {{kR, 0, 0.4, 0.025, -q},
        {kR, 0, 0, 0.455, 0},
        {kR, -q, 0, 0.035, -q},
        {kR, 0, -0.42, 0, q},
        {kR, 0, 0, 0, -q},
        {kR, 0, -0.08, 0, kPi}}},
      {"three parallel axes",
       {{kR, 0, 0.0892, 0, q},
        {kR, 0, 0, -0.425, 0},
        {kR, 0, 0, -0.3923, 0},
        {kR, 0, 0.1092, 0, q},
        {kR, 0, 0.0947, 0, -q},
        {kR, 0, 0.0823, 0, 0}}},
      {"table-top arm",
       {{kR, q, 0.13, 0, 1.5708},
        {kR, q, 0, 0.11, 0},
        {kR, 0, 0.065, 0.095, 0},
        {kR, q, 0, 0, 1.5708},
        {kR, -q, 0.074, 0, 1.5708},
        {kR, 0, 0.046, 0, 0}}},
      {"wrist with an offset",
       {{kR, 0, 0, 0, -q},
        {kR, -q, 0, 0.7, kPi},
        {kR, 0, 0, 0, -q},
        {kR, 0, -0.52, 0, q},
        {kR, 0, 0.145, 0, -q},
        {kR, 0, -0.155, 0, kPi}}},
      {"wrist at sixty degrees",
       {{kR, 0, 0.2755, 0, q},
        {kR, 0, 0, 0.41, kPi},
        {kR, 0, -0.0098, 0, q},
        {kR, 0, -0.2501, 0, kPi / 3},
        {kR, 0, -0.0856, 0, kPi / 3},
        {kR, 0, -0.2028, 0, kPi}}},
  };
}

class Individuals {
 public:
  double any(double most) { return std::uniform_real_distribution<double>(-most, most)(random_); }

  // An arm as it is built, to a tenth of a degree and half a millimetre.
  Chain built(DhRows rows) {
    for (DhJoint& row : rows) {
      row.theta_rad += any(3e-3);
      row.d_m += any(5e-4);
      row.a_m += any(5e-4);
      row.alpha_rad += any(2e-3);
    }
    return make_chain(rows);
  }
  JointVector readings() {
    JointVector q;
    for (int i = 0; i < 6; ++i) q.push_back(any(kPi));
    return q;
  }

 private:
  std::mt19937_64 random_{5};
};

bool is_among(const std::vector<JointVector>& some, const JointVector& q, double tolerance) {
  for (const JointVector& other : some) {
    double apart = 0;
    for (std::size_t i = 0; i < q.size(); ++i) {
      apart = std::max(apart, std::abs(wrap_angle(other[i] - q[i])));
    }
    if (apart < tolerance) return true;
  }
  return false;
}

bool is_met(const InverseSolution& solution) {
  return solution.verdict == Verdict::kConverged || solution.verdict == Verdict::kDegraded;
}

// By random starts, the readings that made the pose among them.
std::vector<JointVector> by_random_starts(const Chain& chain, const Pose& X, const JointVector& q,
                                          Individuals& random) {
  std::vector<JointVector> found{q};
  const InverseOptions options{.max_iterations = 60};
  for (int k = 0; k < 200; ++k) {
    const auto solution = inverse(chain, X, random.readings(), options);
    if (is_met(*solution) && !is_among(found, solution->q, 1e-5)) found.push_back(solution->q);
  }
  return found;
}

TEST(PostureSearch, finds_every_posture_that_two_hundred_starts_find) {
  Individuals random;
  int postures = 0;
  for (const NamedRows& arm : six_axis_arms()) {
    for (int k = 0; k < 12; ++k) {
      const Chain chain = random.built(arm.rows);
      ASSERT_TRUE(can_search_postures(chain)) << arm.name;
      const JointVector q = random.readings();
      const Pose X = *forward(chain, q);
      std::vector<JointVector> found;
      for (const NamedSolution& s : *cold_start(chain, closed_form(chain), X)) {
        EXPECT_LT(test::pose_difference(*forward(chain, s.solution.q), X), 1e-9) << arm.name;
        EXPECT_FALSE(is_among(found, s.solution.q, 1e-4)) << arm.name << ": listed twice";
        found.push_back(s.solution.q);
      }
      for (const JointVector& one : by_random_starts(chain, X, q, random)) {
        EXPECT_TRUE(is_among(found, one, 1e-4)) << arm.name << ", pose " << k;
        ++postures;
      }
    }
  }
  EXPECT_GT(postures, 400);
}

// Where a wrist is straight within this, its two postures bend in directions that only the arm as
// it is decides.
TEST(PostureSearch, finds_the_posture_that_an_arm_with_a_straight_wrist_stands_in) {
  Individuals random;
  for (const NamedRows& arm : six_axis_arms()) {
    for (const double straight : {1e-3, 1e-5, 1e-7, 1e-9, 1e-12}) {
      for (int k = 0; k < 5; ++k) {
        const Chain chain = random.built(arm.rows);
        JointVector q = random.readings();
        q[4] = random.any(straight) - chain.theta[4];
        const Pose X = *forward(chain, q);
        EXPECT_FALSE(cold_start(chain, closed_form(chain), X)->empty())
            << arm.name << " within " << straight;
      }
    }
  }
}

TEST(PostureSearch, lists_a_posture_once_whose_joints_can_move_without_the_flange) {
  Individuals random;
  const Chain chain = make_chain(six_axis_arms()[0].rows);
  for (int k = 0; k < 10; ++k) {
    JointVector q = random.readings();
    q[4] = 0;
    const Pose X = *forward(chain, q);
    const Solutions solutions = *cold_start(chain, closed_form(chain), X);
    EXPECT_FALSE(solutions.empty());
    EXPECT_LE(solutions.size(), 8U);
  }
}

// Where the joints are free between each other they are put inside the limits.
TEST(PostureSearch, puts_free_joints_inside_their_limits) {
  Individuals random;
  FixedVector<JointLimits, kMaxJoints> limits;
  for (int i = 0; i < 6; ++i) limits.push_back({-3.1, 3.1});
  limits[3] = {0.2, 0.6};
  const Chain chain = make_chain(six_axis_arms()[0].rows, limits);
  for (int k = 0; k < 10; ++k) {
    const JointVector q{random.any(2.5), random.any(2.5), random.any(2.5), 0.4, 0, random.any(2.5)};
    const Solutions solutions = *cold_start(chain, closed_form(chain), *forward(chain, q));
    ASSERT_FALSE(solutions.empty());
    EXPECT_TRUE(is_met(solutions[0].solution)) << k;
    EXPECT_GE(solutions[0].solution.q[3], 0.2);
    EXPECT_LE(solutions[0].solution.q[3], 0.6);
  }
}

// Arms are parked at limits: what rounding leaves beyond one is no reason to refuse a pose.
TEST(PostureSearch, meets_poses_exactly_at_joint_limits) {
  Individuals random;
  for (const NamedRows& arm : six_axis_arms()) {
    for (int k = 0; k < 20; ++k) {
      const JointVector q = random.readings();
      FixedVector<JointLimits, kMaxJoints> limits;
      for (std::size_t i = 0; i < 6; ++i) {
        const bool upper = (static_cast<std::size_t>(k) + i) % 2 == 0;
        limits.push_back(upper ? JointLimits{q[i] - 1, q[i]} : JointLimits{q[i], q[i] + 1});
      }
      const Chain chain = make_chain(arm.rows, limits);
      const Solutions solutions = *cold_start(chain, closed_form(chain), *forward(chain, q));
      ASSERT_FALSE(solutions.empty()) << arm.name;
      EXPECT_TRUE(is_met(solutions[0].solution)) << arm.name << ", pose " << k;
    }
  }
}

TEST(PostureSearch, has_nothing_to_list_out_of_reach) {
  for (const NamedRows& arm : six_axis_arms()) {
    const Chain chain = make_chain(arm.rows);
    Pose X = *forward(chain, {0.1, 0.2, 0.3, 0.4, 0.5, 0.6});
    X.p *= 4;
    EXPECT_TRUE(cold_start(chain, closed_form(chain), X)->empty()) << arm.name;
  }
}

TEST(PostureSearch, is_for_arms_of_its_form_alone) {
  const auto arms = six_axis_arms();
  DhRows rows = arms[0].rows;
  rows[0].alpha_rad = 1;
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "axes 1 and 2 not at right angles";
  rows = arms[0].rows;
  rows[1].alpha_rad = 0.1;
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "axes 2 and 3 not parallel";
  rows = arms[0].rows;
  rows[3].a_m = 0.05;
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "axes 4 and 5 do not meet";
  rows = arms[0].rows;
  rows[1].a_m = 0;
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "no upper arm";
  rows = arms[0].rows;
  rows[2].type = JointType::kPrismatic;
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "a prismatic joint";
  rows.resize(5);
  EXPECT_FALSE(can_search_postures(make_chain(rows))) << "five joints";
}

}  // namespace
}  // namespace armsig::kinematics
