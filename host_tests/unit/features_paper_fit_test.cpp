// SPDX-License-Identifier: MIT
// The paper's fits themselves, on points that no gate has touched.
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/motion_fits.hpp"
#include "core/features/regressions.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/fitted_points.hpp"

namespace armsig::features {
namespace {

using test::circle_about;
using test::exact_points;
using test::fitted_by;
using test::kNoisyCircle;
using test::noisy_circle;

// Golden values: numpy.linalg.lstsq over the points themselves, with x as the regressed coordinate.
TEST(PlaneOfRotation, is_the_regression_13_with_the_pivot_nearest_to_the_normal) {
  const auto plane = plane_of_rotation(noisy_circle(Method::kPaper).geometry());
  ASSERT_TRUE(plane);
  const Vector3 normal(0.873171586686611, -0.4353601480524273, 0.21916414326014846);
  EXPECT_LT((plane->normal_S - normal).norm(), 1e-11);
  EXPECT_NEAR(plane->distance_m + normal.dot(Vector3(kNoisyCircle[0].p_S)), 0.8963469150088447,
              1e-11);
}

// Golden values: the points projected onto that plane, (14) by numpy.linalg.lstsq.
TEST(CentreOfRotation, is_the_regression_14_of_the_projected_points) {
  const SweepStatistics statistics = noisy_circle(Method::kPaper);
  const auto plane = plane_of_rotation(statistics.geometry());
  ASSERT_TRUE(plane);
  const auto circle =
      centre_of_rotation(statistics.geometry(), *plane, squared_distance_in_plane(*plane));
  ASSERT_TRUE(circle);
  const Vector3 centre(0.29947236110749104, -0.20003694879745362, 2.499350644221093);
  EXPECT_LT((statistics.origin_S + circle->centre - centre).norm(), 1e-11);
  EXPECT_NEAR(circle->radius_m, 0.39962650518295206, 1e-11);
}

// Sums over the points of the products of 1, x, y, z, |p|^2, xx, xy, xz, yy, yz.
using GeometryProducts = Eigen::Matrix<double, 10, 10>;
GeometryProducts products_of(const Geometry& geometry) {
  Eigen::Matrix<double, 4, 10> rows;
  rows << geometry.factor(), geometry.rotated_right_hand_sides();
  GeometryProducts products = rows.transpose() * rows;
  products.bottomRightCorner<6, 6>() += geometry.residual_products();
  return products;
}

// What the encoder's method keeps in place of the points' geometry says as much of its first
// columns.
TEST(Geometry, of_the_encoders_method_is_that_of_the_points) {
  const Geometry kept = noisy_circle(Method::kEncoder).geometry();
  const GeometryProducts products = products_of(kept);
  const GeometryProducts expected = products_of(noisy_circle(Method::kPaper).geometry());
  const GeometryProducts difference = products - expected;
  EXPECT_LT((difference.topLeftCorner<5, 5>().norm()),
            1e-12 * (expected.topLeftCorner<5, 5>().norm()));
  EXPECT_TRUE(kept.rotated_right_hand_sides().rightCols<5>().isZero(0));
  EXPECT_TRUE(kept.residual_products().bottomRows<5>().isZero(0));
}

TEST(Geometry, of_the_papers_method_is_that_of_the_points) {
  test::Random random(3);
  SweepStatistics statistics(JointType::kRevolute, Method::kPaper);
  GeometryProducts expected = GeometryProducts::Zero();
  for (int i = 0; i < 50; ++i) {
    const Vector3 p_S = random.normal_vector();
    const double sigma = 1 + i % 3;
    statistics.add({0.1 * i, p_S, test::isotropic(sigma)});
    const Vector3 p = p_S - statistics.origin_S;
    GeometryRow row;
    row << 1, p, p.squaredNorm(), p.x() * p, p.y() * p.y(), p.y() * p.z();
    expected += row * row.transpose() / (sigma * sigma);
  }
  EXPECT_LT((products_of(statistics.geometry()) - expected).norm(), 1e-12 * expected.norm());
}

// The residuals summed point by point; near the plane, to first order in the distance from it, here
// a tenth of a millimetre at 0.4 m.
TEST(CentreOfRotation, tells_the_residuals_of_14) {
  const SweepStatistics statistics = noisy_circle(Method::kPaper);
  const auto geometry = statistics.geometry();
  const auto plane = plane_of_rotation(geometry);
  ASSERT_TRUE(plane);
  const auto exact = centre_of_rotation(geometry, *plane, squared_distance_in_plane(*plane));
  const auto near = centre_of_rotation(geometry, *plane, squared_distance_near_plane(*plane));
  ASSERT_TRUE(exact && near);
  const Vector3& n = plane->normal_S;
  double squares = 0;
  for (const test::CirclePoint& point : kNoisyCircle) {
    const Vector3 from_centre = Vector3(point.p_S) - statistics.origin_S - exact->centre;
    const Vector3 in_plane = from_centre - n.dot(from_centre) * n;
    squares += std::pow(in_plane.squaredNorm() - std::pow(exact->radius_m, 2), 2) / 4e-8;
  }
  EXPECT_NEAR(exact->residual_squares, squares, 1e-9 * squares);
  EXPECT_NEAR(near->residual_squares, squares, 2e-3 * squares);
  EXPECT_LT((near->centre - exact->centre).norm(), 1e-6);
}

TEST(PlaneOfRotation, may_contain_the_sensors_z_axis) {
  for (const Vector3& axis : {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1),
                              Vector3(0.6, 0.8, 0), Vector3(0.6, 0, 0.8)}) {
    const auto plane = plane_of_rotation(exact_points(circle_about(axis), 2, 20).geometry());
    ASSERT_TRUE(plane);
    EXPECT_LT(plane->normal_S.cross(axis).norm(), 1e-14);
  }
}

// Along this short arc the points spread least in a coordinate that lies in their plane.
TEST(PlaneOfRotation, chooses_a_pivot_out_of_the_plane_on_a_short_arc) {
  test::TrueMotion motion;
  motion.radius_m = 0.5;
  motion.R_SC.col(1) = Vector3(0.57, 0.58, 0.59).normalized();  // the chord
  motion.R_SC.col(2) = Vector3(0, 0.59, -0.58).normalized();
  motion.R_SC.col(0) = motion.R_SC.col(1).cross(motion.R_SC.col(2));
  const auto plane = plane_of_rotation(exact_points(motion, 0.2, 20).geometry());
  ASSERT_TRUE(plane);
  EXPECT_LT(plane->normal_S.cross(motion.R_SC.col(2)).norm(), 1e-12);
}

TEST(PlaneOfRotation, of_points_on_a_line_is_refused) {
  test::TrueMotion line;
  line.type = JointType::kPrismatic;
  const auto plane = plane_of_rotation(exact_points(line, 1, 10).geometry());
  ASSERT_FALSE(plane);
  EXPECT_EQ(test::failure_of(plane), Error::kSingular);
}

TEST(LineOfTranslation, is_found_along_every_coordinate) {
  for (int i = 0; i < 3; ++i) {
    test::TrueMotion motion;
    motion.type = JointType::kPrismatic;
    motion.R_SC.col(2) = (Vector3::Unit(i) + Vector3(0.1, -0.05, 0.02)).normalized();
    const auto line = line_of_translation(exact_points(motion, 0.4, 9).geometry());
    ASSERT_TRUE(line);
    EXPECT_LT(line->direction_S.cross(motion.R_SC.col(2)).norm(), 1e-15);
  }
}

TEST(LineOfTranslation, of_coincident_points_is_refused) {
  SweepStatistics statistics(JointType::kPrismatic, Method::kPaper);
  for (int i = 0; i < 5; ++i) statistics.add({0.1 * i, Vector3::Zero(), Matrix3::Identity()});
  ASSERT_FALSE(line_of_translation(statistics.geometry()));
  EXPECT_EQ(test::failure_of(line_of_translation(statistics.geometry())), Error::kSingular);
}

TEST(PaperCircle, turns_in_the_positive_sense_of_the_reading) {
  for (const double sense : {1.0, -1.0}) {
    const test::TrueMotion motion = circle_about(sense * Vector3(0.6, 0, 0.8));
    const auto circle = fitted_by(paper_circle, exact_points(motion, 1, 15));
    ASSERT_TRUE(circle);
    EXPECT_LT((circle->radial_S - motion.R_SC.col(0)).norm(), 1e-12);
    EXPECT_LT((circle->axis_S - motion.R_SC.col(2)).norm(), 1e-12);
  }
}

TEST(PaperLine, points_in_the_positive_sense_of_the_reading) {
  test::TrueMotion motion;
  motion.type = JointType::kPrismatic;
  motion.R_SC.col(2) = Vector3(-0.6, 0, 0.8);
  const auto line = fitted_by(paper_line, exact_points(motion, -0.3, 7));
  ASSERT_TRUE(line);
  EXPECT_LT((line->axis_S - motion.R_SC.col(2)).norm(), 1e-15);
}

}  // namespace
}  // namespace armsig::features
