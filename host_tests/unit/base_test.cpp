// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"

namespace armsig {
namespace {

TEST(Pose, composition_chains_frames) {
  const Pose X_AB{rotation_z(kPi / 2), Vector3(1, 0, 0)};
  const Pose X_BC{Matrix3::Identity(), Vector3(2, 0, 0)};
  EXPECT_TRUE((X_AB * X_BC).p.isApprox(Vector3(1, 2, 0), 1e-15));
}

TEST(Pose, inverse_undoes) {
  const Pose X{rotation_z(0.3) * rotation_x(-1.1), Vector3(1, -2, 3)};
  EXPECT_TRUE((X * X.inverse()).R.isIdentity(1e-15));
  EXPECT_LT((X * X.inverse()).p.norm(), 1e-15);
}

TEST(RotationVector, keeps_precision_for_an_angle_of_a_picoradian) {
  EXPECT_NEAR(rotation_vector(rotation_x(1e-12)).x(), 1e-12, 1e-27);
}

TEST(RotationVector, is_right_near_half_a_turn) {
  EXPECT_NEAR(rotation_vector(rotation_z(kPi - 1e-9)).norm(), kPi - 1e-9, 1e-14);
}

TEST(WrapAngle, returns_plus_pi_for_both_half_turns) {
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
}

TEST(AnyPerpendicular, is_unit_and_perpendicular_for_every_axis) {
  for (const Vector3& v : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)}) {
    EXPECT_NEAR(any_perpendicular(v).norm(), 1, 1e-15);
    EXPECT_NEAR(any_perpendicular(v).dot(v), 0, 1e-15);
  }
}

TEST(FixedVector, traps_beyond_its_capacity) {
  FixedVector<int, 1> v{1};
  EXPECT_DEATH(v.push_back(2), "");
}

TEST(Error, every_error_has_words) { EXPECT_NE(describe(Error::kJointLimit), "unknown error"); }

}  // namespace
}  // namespace armsig
