// SPDX-License-Identifier: MIT
// The grid-touching task on a Puma 560 (Table 1 of the paper).
#include <cmath>

#include <gtest/gtest.h>

#include "core/evaluation/grid_touching.hpp"
#include "core/evaluation/tool_pose.hpp"
#include "core/kinematics/forward.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::evaluation {
namespace {

DhJoint revolute(double theta_deg, double d_m, double a_m, double alpha_deg) {
  return {JointType::kRevolute, radians(theta_deg), d_m, a_m, radians(alpha_deg)};
}

ToolModel puma560(double theta_3_offset_deg = 0, double alpha_2_deg = 0) {
  const DhRows rows{revolute(0, 0, 0, -90),
                    revolute(0, 0.14909, 0.4318, alpha_2_deg),
                    revolute(theta_3_offset_deg, 0, -0.02032, 90),
                    revolute(0, 0.4307, 0, -90),
                    revolute(0, 0, 0, 90),
                    revolute(0, 0, 0, 0)};
  FixedVector<JointLimits, kMaxJoints> limits;
  for (const auto& [lower, upper] :
       {std::pair{-160, 160}, {-225, 45}, {-45, 225}, {-110, 170}, {-100, 100}, {-266, 266}}) {
    limits.push_back({radians(lower), radians(upper)});
  }
  return {kinematics::make_chain(rows, limits), Vector3(0, 0, 0.1)};
}

// Row by row, layer by layer; each row and each layer is begun from the one before, so that no move
// is longer than a spacing.
TEST(VertexWalk, goes_through_all_vertices_each_from_one_beside_it) {
  const Grid grid{.size_m = {0.1, 0.2, 0.3}, .count = {2, 3, 4}};
  const auto readings = [](const Vector3& p) { return JointVector{p.x(), p.y(), p.z()}; };
  VertexWalk walk(grid, readings(Vector3::Zero()));
  for (int n = 0; n < 24; ++n) {
    ASSERT_TRUE(walk.next()) << n;
    const Vector3 expected = 0.1 * Vector3(n % 2, n / 2 % 3, n / 6);
    EXPECT_LT((walk.vertex() - expected).norm(), 1e-15) << n;
    const Vector3 from(walk.seed()[0], walk.seed()[1], walk.seed()[2]);
    EXPECT_LT((expected - from).norm(), 0.1 + 1e-15) << n;
    walk.reached(readings(expected));
  }
  EXPECT_FALSE(walk.next());
}

TEST(PlaceGrid, finds_room_for_the_papers_grid_in_a_puma_560) {
  const auto placement = place_grid(puma560(), Grid{});
  ASSERT_TRUE(placement);
  EXPECT_EQ(placement->grid.size_m, Grid{}.size_m);
}

TEST(PlaceGrid, teaches_points_that_span_the_grid) {
  const ToolModel arm = puma560();
  const auto placement = place_grid(arm, Grid{});
  ASSERT_TRUE(placement);
  const auto tool_at = [&](std::size_t n) {
    const Pose X_0n = *kinematics::forward(arm.chain, placement->taught[n]);
    return Vector3(X_0n * arm.p_nT);
  };
  EXPECT_NEAR((tool_at(1) - tool_at(0)).norm(), 0.25, 1e-8);
  EXPECT_NEAR((tool_at(2) - tool_at(0)).norm(), 0.25, 1e-8);
}

TEST(PlaceGrid, shrinks_a_grid_that_is_larger_than_the_arm) {
  const auto placement = place_grid(puma560(), Grid{.size_m = {1.5, 1.5, 1.5}, .count = {4, 4, 4}});
  ASSERT_TRUE(placement);
  EXPECT_LT(placement->grid.size_m[0], 1.0);
}

TEST(PlaceGrid, takes_a_fifth_off_all_sides_until_the_grid_fits_at_most_eleven_times) {
  const auto placed = [](double size_m) {
    return place_grid(puma560(),
                      Grid{.size_m = {size_m, size_m / 2, size_m / 4}, .count = {2, 2, 2}});
  };
  const auto fitting = placed(3);
  ASSERT_TRUE(fitting);
  const double fits_m = fitting->grid.size_m[0];
  const double times = std::log(fits_m / 3) / std::log(0.8);
  EXPECT_GT(times, 0.5);
  EXPECT_NEAR(times, std::round(times), 1e-9);
  EXPECT_NEAR(fitting->grid.size_m[1], fits_m / 2, 1e-12);
  EXPECT_NEAR(fitting->grid.size_m[2], fits_m / 4, 1e-12);
  const auto as_it_is = placed(fits_m);
  ASSERT_TRUE(as_it_is);
  EXPECT_EQ(as_it_is->grid.size_m[0], fits_m);
  const auto the_most = placed(fits_m / std::pow(0.8, 11));
  ASSERT_TRUE(the_most);
  EXPECT_NEAR(the_most->grid.size_m[0], fits_m, 1e-12);
  EXPECT_EQ(test::failure_of(placed(fits_m / std::pow(0.8, 12))), Error::kOutOfReach);
}

// Two links in a plane, of which only one place that is tried lets a grid of this size in.
ToolModel two_links(const JointLimits& shoulder, const JointLimits& elbow) {
  const DhRows rows{{JointType::kRevolute, 0, 0, 0.5, 0}, {JointType::kRevolute, 0, 0, 0.4, 0}};
  return {kinematics::make_chain(rows, {shoulder, elbow}), Vector3::Zero()};
}

Result<GridPlacement> place_in_plane(const ToolModel& arm, double size_m, double share) {
  return place_grid(arm, Grid{.size_m = {size_m, share * size_m, 0}, .count = {2, 2, 2}});
}

// The middle of the limits is the first of 96 places: from there the largest grid fits that fits at
// all.
TEST(PlaceGrid, tries_the_middle_of_the_limits) {
  const auto placement = place_in_plane(two_links({0.15, 1.65}, {0.9, 3.2}), 0.368, 1.5);
  ASSERT_TRUE(placement);
  EXPECT_EQ(placement->grid.size_m[0], 0.368);
}

// The last of the places that are tried is the only one with room; a place that would be tried next
// is, and the grid shrinks.
TEST(PlaceGrid, tries_96_places_before_it_shrinks_a_grid) {
  const auto at_the_last = place_in_plane(two_links({0.85, 3.15}, {-0.1, 0.75}), 0.055, 1.3);
  ASSERT_TRUE(at_the_last);
  EXPECT_EQ(at_the_last->grid.size_m[0], 0.055);
  const auto at_the_next = place_in_plane(two_links({0.3, 2.7}, {-1.1, -0.1}), 0.096, 1.2);
  ASSERT_TRUE(at_the_next);
  EXPECT_EQ(at_the_next->grid.size_m[0], 0.8 * 0.096);
}

TEST(PlaceGrid, gives_up_on_a_grid_ten_times_too_large) {
  const auto placement = place_grid(puma560(), Grid{.size_m = {30, 30, 30}, .count = {2, 2, 2}});
  ASSERT_FALSE(placement);
  EXPECT_EQ(test::failure_of(placement), Error::kOutOfReach);
}

TEST(TouchGrid, with_the_true_model_touches_every_vertex) {
  const ToolModel arm = puma560();
  const auto placement = place_grid(arm, Grid{});
  ASSERT_TRUE(placement);
  const auto readings = touch_grid(arm, arm, *placement);
  ASSERT_TRUE(readings);
  const Indices result = indices(placement->grid, *readings);
  EXPECT_LT(result.radial_deviation_m, 1e-8);
  EXPECT_LT(result.orientation_deviation_rad, 1e-8);
}

TEST(TouchGrid, shows_an_offset_of_joint_3_that_the_model_does_not_know) {
  const ToolModel truth = puma560(0.5);
  const auto placement = place_grid(puma560(), Grid{});
  ASSERT_TRUE(placement);
  const auto readings = touch_grid(puma560(), truth, *placement);
  ASSERT_TRUE(readings);
  const Indices result = indices(placement->grid, *readings);
  EXPECT_GT(result.radial_deviation_m, 1e-3);
  EXPECT_GT(result.perpendicular_deviation_rad, radians(0.05));
}

// Joint 2's encoder disc is off its centre, joint 3 hangs on joint 2.
TEST(TouchGrid, turns_by_the_readings_as_told) {
  calibration::ReadingModel wave{.couplings = {}, .corrections = {}, .deflections = nullptr};
  wave.couplings.push_back({.joint = 2, .from = 1, .ratio = -1});
  for (std::size_t j = 0; j < 6; ++j) wave.corrections.push_back({.sin_1 = j == 1 ? 0.01 : 0});
  const ToolModel arm = puma560();
  const Turning turning{&wave, {0.1, -0.8, 1.2, 0.3, 0.4, -0.5}};
  const auto placement = place_grid(arm, Grid{});
  ASSERT_TRUE(placement);
  const auto radial_m = [&](const Turning& of_model, const Turning& of_truth) {
    const auto readings = touch_grid(arm, arm, *placement, of_model, of_truth);
    return readings ? indices(placement->grid, *readings).radial_deviation_m : kPi;
  };
  EXPECT_LT(radial_m(turning, turning), 1e-7);
  EXPECT_GT(radial_m({}, turning), 1e-4);
  EXPECT_GT(radial_m(turning, {}), 1e-4);
}

TEST(TouchGrid, does_not_see_where_frame_0_and_frame_n_are) {
  ToolModel moved = puma560();
  moved.chain.theta[0] += 0.7;  // frame 0 turned about joint 1
  moved.chain.theta[5] -= 1.1;  // frame n turned about joint 6, the tool with it
  moved.p_nT = rotation_z(1.1) * moved.p_nT;
  const auto placement = place_grid(puma560(), Grid{});
  ASSERT_TRUE(placement);
  const auto readings = touch_grid(moved, puma560(), *placement);
  ASSERT_TRUE(readings);
  EXPECT_LT(indices(placement->grid, *readings).radial_deviation_m, 1e-8);
  EXPECT_LT(indices(placement->grid, *readings).orientation_deviation_rad, 1e-8);
}

}  // namespace
}  // namespace armsig::evaluation
