// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/forward.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/kinematics_random.hpp"
#include "host_tests/support/kinematics_reference.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::kinematics {
namespace {

double largest_difference(const test::Matrix4L& reference, const Pose& X) {
  long double largest = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    for (std::size_t c = 0; c < 3; ++c) {
      const auto entry = static_cast<long double>(X.R(row, static_cast<Eigen::Index>(c)));
      largest = std::max(largest, std::abs(reference[r][c] - entry));
    }
    largest = std::max(largest, std::abs(reference[r][3] - static_cast<long double>(X.p[row])));
  }
  return static_cast<double>(largest);
}

// A_1 ... A_6 of (1) and (2) with Table 1 at (10, -20, 30, -40, 50, -60) degrees, by mpmath with 30
// digits.
TEST(Forward, gives_the_worked_example_of_the_puma) {
  const JointVector q{radians(10),  radians(-20), radians(30),
                      radians(-40), radians(50),  radians(-60)};
  const Pose X = *forward(make_chain(test::puma560().joints), q);
  const Matrix3 R{{-0.21553310377241479, 0.60745165367577732, 0.76455736843273767},
                  {-0.92142738689216451, 0.13270027428127828, -0.36518790764584592},
                  {-0.32329097089666277, -0.78319418131919047, 0.53112128792250094}};
  const Vector3 p(0.42765243258203131, 0.22679661579586567, 0.57536952808057379);
  EXPECT_LT((X.R - R).cwiseAbs().maxCoeff(), 2e-15);
  EXPECT_LT((X.p - p).cwiseAbs().maxCoeff(), 2e-15);
}

TEST(Forward, agrees_with_the_product_of_matrices_in_extended_precision) {
  std::mt19937_64 random(1);
  for (const test::KnownArm& arm : test::known_arms()) {
    const Chain chain = make_chain(arm.joints);
    double largest = 0;
    for (int k = 0; k < 2000; ++k) {
      const JointVector q = test::random_readings(arm, random);
      largest = std::max(
          largest, largest_difference(test::reference_pose(arm.joints, q), *forward(chain, q)));
    }
    EXPECT_LT(largest, 2e-13) << arm.name;
  }
}

TEST(Forward, works_for_one_to_eight_joints_of_either_type) {
  std::mt19937_64 random(3);
  for (int k = 0; k < 400; ++k) {
    DhRows rows;
    JointVector q;
    const auto count = 1 + static_cast<std::size_t>(k) % kMaxJoints;
    for (std::size_t i = 0; i < count; ++i) {
      rows.push_back({k % 3 == 0 && i % 2 == 1 ? JointType::kPrismatic : JointType::kRevolute,
                      test::uniform(random, -4, 4), test::uniform(random, -1, 1),
                      test::uniform(random, -1, 1), test::uniform(random, -4, 4)});
      q.push_back(test::uniform(random, -4, 4));
    }
    const auto reference = test::reference_pose(rows, q);
    EXPECT_LT(largest_difference(reference, *forward(make_chain(rows), q)), 2e-14);
  }
}

TEST(Forward, is_right_after_ten_thousand_turns_and_beyond_the_polynomials) {
  std::mt19937_64 random(4);
  const test::KnownArm arm = test::puma560();
  const Chain chain = make_chain(arm.joints);
  for (const double turns : {1e4, 1e5, 1e7, 1e12}) {
    for (int k = 0; k < 200; ++k) {
      JointVector q;
      for (std::size_t i = 0; i < 6; ++i)
        q.push_back(test::uniform(random, -1, 1) * turns * 2 * kPi);
      EXPECT_LT(largest_difference(test::reference_pose(arm.joints, q), *forward(chain, q)), 4e-15);
    }
  }
}

TEST(Forward, refuses_a_reading_that_is_not_finite) {
  for (const test::KnownArm& arm : {test::puma560(), test::stanford()}) {
    const Chain chain = make_chain(arm.joints);
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
          -std::numeric_limits<double>::infinity()}) {
      for (std::size_t joint = 0; joint < 6; ++joint) {
        JointVector q(6, 0.1);
        q[joint] = bad;
        EXPECT_EQ(test::failure_of(forward(chain, q)), Error::kNotFinite);
        EXPECT_EQ(test::failure_of(forward_with_jacobian(chain, q)), Error::kNotFinite);
      }
    }
  }
}

TEST(Forward, ignores_what_stands_beyond_the_last_joint) {
  JointVector q(8, std::numeric_limits<double>::quiet_NaN());
  q.resize(3);
  for (double& reading : q) reading = 0.2;
  DhRows rows = test::puma560().joints;
  rows.resize(3);
  EXPECT_TRUE(forward(make_chain(rows), q).has_value());
}

TEST(ForwardWithJacobian, agrees_with_central_differences) {
  constexpr double kStep = 1e-5;
  std::mt19937_64 random(5);
  for (const test::KnownArm& arm : test::known_arms()) {
    const Chain chain = make_chain(arm.joints);
    const JointVector q = test::random_readings(arm, random);
    const PoseAndJacobian at = *forward_with_jacobian(chain, q);
    EXPECT_EQ(at.X_0n.p, forward(chain, q)->p);
    for (std::size_t i = 0; i < q.size(); ++i) {
      JointVector more = q;
      JointVector less = q;
      more[i] += kStep;
      less[i] -= kStep;
      const Pose X_more = *forward(chain, more);
      const Pose X_less = *forward(chain, less);
      Eigen::Matrix<double, 6, 1> rate;
      rate.head<3>() = (X_more.p - X_less.p) / (2 * kStep);
      rate.tail<3>() = rotation_vector(X_more.R * X_less.R.transpose()) / (2 * kStep);
      const auto column = at.J.col(static_cast<Eigen::Index>(i));
      EXPECT_LT((column - rate).cwiseAbs().maxCoeff(), 1e-9) << arm.name << " joint " << i + 1;
    }
  }
}

TEST(ForwardWithJacobian, leaves_columns_beyond_the_last_joint_zero) {
  const test::KnownArm arm = test::cobra600();
  const PoseAndJacobian at = *forward_with_jacobian(make_chain(arm.joints), {0.1, 0.2, 0.1, 0.3});
  EXPECT_TRUE((at.J.rightCols<4>().array() == 0).all());
}

}  // namespace
}  // namespace armsig::kinematics
