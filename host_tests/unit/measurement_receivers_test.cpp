// SPDX-License-Identifier: MIT
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/receivers.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::measurement {
namespace {

Vector3 up() { return Vector3::UnitZ(); }

ReceiverArray tetrahedron() {
  return {.p_S = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 1}}, .range_sigma_m = 1e-4};
}

ReceiverArray flat_square() {
  return {.p_S = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}}, .range_sigma_m = 1e-4};
}

TEST(Spread, gives_centroid_and_principal_axes) {
  // A 4 m by 2 m rectangle, turned by 30 degrees about z: standard deviations 2, 1, 0.
  const Matrix3 R = rotation_z(radians(30));
  const Spread spread = spread_of(
      {R * Vector3(3, 2, 5), R * Vector3(-1, 2, 5), R * Vector3(3, 0, 5), R * Vector3(-1, 0, 5)});
  EXPECT_LT((spread.centroid - R * Vector3(1, 1, 5)).norm(), 1e-14);
  EXPECT_LT((spread.rms - Vector3(2, 1, 0)).norm(), 1e-7);
  EXPECT_NEAR(std::abs(spread.axes.col(0).dot(R.col(0))), 1, 1e-14);
  EXPECT_NEAR(std::abs(spread.axes.col(2).dot(up())), 1, 1e-14);
}

TEST(ReceiverCheck, accepts_receivers_that_fill_space) { EXPECT_TRUE(check(tetrahedron())); }

TEST(ReceiverCheck, accepts_a_flat_array_that_says_where_it_faces) {
  ReceiverArray array = flat_square();
  array.facing_S = -up();
  EXPECT_TRUE(check(array));
}

TEST(ReceiverCheck, refuses_fewer_than_three) {
  ReceiverArray array = tetrahedron();
  array.p_S.resize(2, Vector3::Zero());
  EXPECT_EQ(test::failure_of(check(array)), Error::kTooFewReceivers);
  array.p_S.clear();
  EXPECT_EQ(test::failure_of(check(array)), Error::kTooFewReceivers);
}

TEST(ReceiverCheck, refuses_a_line_whatever_it_faces) {
  ReceiverArray array{.p_S = {{0, 0, 1}, {1, 2, 1}, {2, 4, 1}, {5, 10, 1}},
                      .range_sigma_m = 1e-4,
                      .facing_S = up()};
  EXPECT_EQ(test::failure_of(check(array)), Error::kReceiversCollinear);
}

TEST(ReceiverCheck, refuses_receivers_in_one_point_as_collinear) {
  ReceiverArray array{
      .p_S = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, .range_sigma_m = 1e-4, .facing_S = up()};
  EXPECT_EQ(test::failure_of(check(array)), Error::kReceiversCollinear);
}

TEST(ReceiverCheck, refuses_a_plane_without_a_side) {
  EXPECT_EQ(test::failure_of(check(flat_square())), Error::kMirrorAmbiguity);
}

TEST(ReceiverCheck, refuses_three_receivers_without_a_side) {
  ReceiverArray array = tetrahedron();
  array.p_S.resize(3, Vector3::Zero());
  EXPECT_EQ(test::failure_of(check(array)), Error::kMirrorAmbiguity);
}

TEST(ReceiverCheck, refuses_a_facing_direction_in_the_plane) {
  ReceiverArray array = flat_square();
  array.facing_S = Vector3(1, 1, 0);
  EXPECT_EQ(test::failure_of(check(array)), Error::kMirrorAmbiguity);
  array.facing_S = Vector3::Zero();
  EXPECT_EQ(test::failure_of(check(array)), Error::kMirrorAmbiguity);
}

TEST(ReceiverCheck, takes_a_plane_for_one_to_a_millimetre_per_metre) {
  ReceiverArray array = flat_square();
  array.p_S[3].z() = 1e-3;
  EXPECT_EQ(test::failure_of(check(array)), Error::kMirrorAmbiguity);
  array.p_S[3].z() = 1e-2;
  EXPECT_TRUE(check(array));
}

TEST(ReceiverCheck, refuses_what_is_not_a_number) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  ReceiverArray array = tetrahedron();
  array.p_S[1].y() = kNan;
  EXPECT_EQ(test::failure_of(check(array)), Error::kNotFinite);
  array = tetrahedron();
  array.range_sigma_m = kNan;
  EXPECT_EQ(test::failure_of(check(array)), Error::kNotFinite);
  array = tetrahedron();
  array.facing_S = Vector3(0, kNan, 1);
  EXPECT_EQ(test::failure_of(check(array)), Error::kNotFinite);
}

TEST(ReceiverCheck, refuses_a_sigma_that_is_not_positive) {
  ReceiverArray array = tetrahedron();
  array.range_sigma_m = 0;
  EXPECT_EQ(test::failure_of(check(array)), Error::kNotPositive);
}

}  // namespace
}  // namespace armsig::measurement
