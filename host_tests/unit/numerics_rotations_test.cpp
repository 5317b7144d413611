// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "core/numerics/rotations.hpp"

namespace armsig::numerics {
namespace {

// The power series of the exponential of a skew-symmetric matrix.
Matrix3 power_series(const Vector3& turn) {
  Matrix3 term = Matrix3::Identity();
  Matrix3 sum = term;
  for (int k = 1; k < 40; ++k) {
    term = (term * cross_matrix(turn) / k).eval();
    sum += term;
  }
  return sum;
}

TEST(RotationBy, is_the_exponential_of_the_turn) {
  for (const double size : {1e-9, 1e-3, 0.7, 3.0, 4.5}) {
    const Vector3 turn = size * Vector3(2, -1, 2) / 3;
    EXPECT_LT((rotation_by(turn) - power_series(turn)).norm(), 1e-13) << size;
  }
}

TEST(RotationBy, has_the_turn_as_its_logarithm) {
  for (const double size : {1e-12, 1e-6, 0.3, 3.1}) {
    const Vector3 turn = size * Vector3(6, -3, -2) / 7;
    EXPECT_LT((rotation_vector(rotation_by(turn)) - turn).norm(), 1e-14 + 1e-13 * size) << size;
  }
}

TEST(RotationBy, of_no_turn_is_exactly_the_identity) {
  EXPECT_EQ(rotation_by(Vector3::Zero()), Matrix3::Identity());
}

TEST(AngleBetween, keeps_its_digits_next_to_nothing_and_next_to_half_a_turn) {
  for (const double angle : {1e-12, 1e-7, 0.5, kPi / 2, 3.0}) {
    const Vector3 a(3, 0, 0);
    const Vector3 b = 0.2 * Vector3(std::cos(angle), std::sin(angle), 0);
    EXPECT_NEAR(angle_between(a, b), angle, 1e-15 + 1e-14 * angle);
    EXPECT_NEAR(angle_between(a, -b), kPi - angle, 2e-15);
  }
}

}  // namespace
}  // namespace armsig::numerics
