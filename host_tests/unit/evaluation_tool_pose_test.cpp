// SPDX-License-Identifier: MIT
// What the grid's task makes of poses that cannot be computed, and of a slide's limits.
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "core/evaluation/grid_touching.hpp"
#include "core/evaluation/tool_pose.hpp"
#include "host_tests/support/calibration_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::evaluation {
namespace {

using test::Cell;
using test::Random;

TEST(ReadingsFound, are_those_of_a_pose_that_is_met_and_else_say_why_not) {
  using kinematics::Verdict;
  kinematics::InverseSolution solution;
  solution.q = {0.1, 0.2};
  for (const Verdict met : {Verdict::kConverged, Verdict::kDegraded}) {
    solution.verdict = met;
    ASSERT_TRUE(readings_found(solution));
    EXPECT_EQ((*readings_found(solution))[1], 0.2);
  }
  for (const auto& [verdict, error] : {std::pair{Verdict::kOutOfReach, Error::kOutOfReach},
                                       {Verdict::kJointLimit, Error::kJointLimit},
                                       {Verdict::kStepLimit, Error::kNotConverged},
                                       {Verdict::kNotConverged, Error::kNotConverged}}) {
    solution.verdict = verdict;
    EXPECT_EQ(test::failure_of(readings_found(solution)), error);
  }
}

ToolModel puma_tool() {
  return {kinematics::make_chain(test::puma().joints, test::puma().limits), Vector3(0, 0, 0.1)};
}

TEST(TouchGrid, refuses_taught_readings_that_are_no_numbers) {
  const ToolModel arm = puma_tool();
  const auto placement = place_grid(arm, {.size_m = {0.1, 0.1, 0.1}, .count = {2, 2, 2}});
  ASSERT_TRUE(placement);
  for (std::size_t taught = 0; taught < 3; ++taught) {
    GridPlacement wrong = *placement;
    wrong.taught[taught][2] = std::nan("");
    const auto touched = touch_grid(arm, arm, wrong);
    ASSERT_FALSE(touched);
    EXPECT_EQ(test::failure_of(touched), Error::kNotFinite);
  }
  ToolModel far = arm;
  far.p_nT.x() = 1e9;
  const auto solved = joints_for_tool_pose(far, Pose{}, test::cell_configuration());
  ASSERT_FALSE(solved);
}

TEST(PlaceGrid, keeps_a_slide_within_its_limits) {
  Random random(112);
  const Cell cell = test::mixed_cell(random);
  const ToolModel arm{kinematics::make_chain(cell.arm.joints, cell.arm.limits), Vector3(0, 0, 0.1)};
  const auto placement = place_grid(arm, {.size_m = {0.05, 0.05, 0.05}, .count = {2, 2, 2}});
  ASSERT_TRUE(placement);
  for (const JointVector& taught : placement->taught) {
    EXPECT_GE(taught[3], cell.arm.limits[3].lower);
    EXPECT_LE(taught[3], cell.arm.limits[3].upper);
  }
}

}  // namespace
}  // namespace armsig::evaluation
