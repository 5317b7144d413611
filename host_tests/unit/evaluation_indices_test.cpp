// SPDX-License-Identifier: MIT
// The four indices of Table 3 on grids whose deviations are known.
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "core/evaluation/indices.hpp"

namespace armsig::evaluation {
namespace {

const Grid kGrid;

// Readings at every vertex, each displaced by `displaced`.
GridReadings readings_of(const std::function<Vector3(const Vector3&)>& displaced) {
  GridReadings readings;
  for (std::size_t k = 0; k < kGrid.count[2]; ++k) {
    for (std::size_t j = 0; j < kGrid.count[1]; ++j) {
      for (std::size_t i = 0; i < kGrid.count[0]; ++i) {
        readings.p_W.push_back(displaced(kGrid.vertex(i, j, k)));
        readings.turn_rad.push_back(Vector3::Zero());
      }
    }
  }
  return readings;
}

GridReadings perfect() {
  return readings_of([](const Vector3& p) { return p; });
}

TEST(Grid, is_the_papers_25_by_25_by_60_cm) {
  EXPECT_TRUE(kGrid.vertex(5, 5, 6).isApprox(Vector3(0.25, 0.25, 0.60)));
  EXPECT_EQ(kGrid.index(5, 5, 6) + 1, kGrid.vertex_count());
}

TEST(TaughtFrame, has_its_x_axis_through_the_second_and_its_plane_through_the_third_point) {
  const Pose X_FW = taught_frame({1, 2, 3}, {1, 4, 3}, {0, 5, 3});
  EXPECT_TRUE(X_FW.p.isApprox(Vector3(1, 2, 3)));
  EXPECT_TRUE(X_FW.R.col(0).isApprox(Vector3(0, 1, 0)));
  EXPECT_TRUE(X_FW.R.col(1).isApprox(Vector3(-1, 0, 0)));
}

TEST(Indices, of_a_perfect_grid_are_zero) {
  const Indices result = indices(kGrid, perfect());
  EXPECT_LT(result.normal_deviation_m, 1e-15);
  EXPECT_LT(result.perpendicular_deviation_rad, 1e-14);
  EXPECT_LT(result.radial_deviation_m, 1e-15);
  EXPECT_EQ(result.orientation_deviation_rad, 0);
}

TEST(Indices, radial_deviation_is_the_largest_distance_from_the_desired_location) {
  GridReadings readings = perfect();
  readings.p_W[17] += Vector3(1e-3, 2e-3, -2e-3);
  EXPECT_NEAR(indices(kGrid, readings).radial_deviation_m, 3e-3, 1e-15);
}

TEST(Indices, perpendicular_deviation_is_the_angle_of_shear) {
  const double shear = 2e-3;
  const auto readings =
      readings_of([&](const Vector3& p) { return Vector3(p.x() + shear * p.z(), p.y(), p.z()); });
  EXPECT_NEAR(indices(kGrid, readings).perpendicular_deviation_rad, std::atan(shear), 1e-12);
}

TEST(Indices, normal_deviation_is_measured_from_the_line_fitted_to_the_points) {
  const auto bowed = readings_of([](const Vector3& p) {
    const double u = (p.x() - 0.125) / 0.125;
    return Vector3(p.x(), p.y(), p.z() + 1e-3 * (1 - u * u));
  });
  // A total-least-squares line through the six bowed points, by numpy's SVD.
  EXPECT_NEAR(indices(kGrid, bowed).normal_deviation_m, 0.0005333333333333332, 1e-12);
}

TEST(Indices, orientation_deviation_is_the_largest_turn) {
  GridReadings readings = perfect();
  readings.turn_rad[3] = Vector3(0, -0.003, 0.004);
  EXPECT_NEAR(indices(kGrid, readings).orientation_deviation_rad, 5e-3, 1e-17);
}

TEST(Indices, do_not_see_what_the_measuring_machine_does_not_resolve) {
  GridReadings readings = perfect();
  readings.turn_rad[3] = Vector3(0, 0, radians(0.0049));
  quantise(readings, Resolution{});
  EXPECT_EQ(indices(kGrid, readings).orientation_deviation_rad, 0);
  EXPECT_LT(indices(kGrid, readings).radial_deviation_m, std::sqrt(3.0) * 12.7e-6 + 1e-12);
}

}  // namespace
}  // namespace armsig::evaluation
