// SPDX-License-Identifier: MIT
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/kinematics/forward.hpp"
#include "host_tests/support/kinematics_arms.hpp"
#include "host_tests/support/kinematics_reference.hpp"

namespace armsig::kinematics {
namespace {

JointVector random_readings(const test::KnownArm& arm, std::mt19937_64& random) {
  JointVector q;
  for (const JointLimits& limit : arm.limits) {
    q.push_back(std::uniform_real_distribution(limit.lower, limit.upper)(random));
  }
  return q;
}

double largest_difference(const test::Matrix4L& reference, const Pose& X) {
  long double largest = 0;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    for (std::size_t c = 0; c < 3; ++c) {
      largest = std::max(
          largest, std::abs(reference[r][c] -
                            static_cast<long double>(X.R(row, static_cast<Eigen::Index>(c)))));
    }
    largest = std::max(largest, std::abs(reference[r][3] - static_cast<long double>(X.p[row])));
  }
  return static_cast<double>(largest);
}

TEST(Forward, agrees_with_the_product_of_matrices_in_extended_precision) {
  std::mt19937_64 random(1);
  for (const test::KnownArm& arm : test::known_arms()) {
    const Chain chain = make_chain(arm.rows);
    double largest = 0;
    for (int k = 0; k < 2000; ++k) {
      const JointVector q = random_readings(arm, random);
      largest = std::max(largest,
                         largest_difference(test::reference_pose(arm.rows, q), *forward(chain, q)));
    }
    EXPECT_LT(largest, 1e-12) << arm.name;
  }
}

TEST(Forward, refuses_a_reading_that_is_not_finite) {
  const Chain chain = make_chain(test::puma560().rows);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      JointVector q(6, 0.1);
      q[joint] = bad;
      EXPECT_EQ(forward(chain, q).error(), Error::kNotFinite);
    }
  }
}

}  // namespace
}  // namespace armsig::kinematics
