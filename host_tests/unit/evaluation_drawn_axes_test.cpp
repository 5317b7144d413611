// SPDX-License-Identifier: MIT
// The frames in which an arm's axes are said to depart from the drawing.
#include <gtest/gtest.h>

#include "core/evaluation/drawn_axes.hpp"
#include "core/kinematics/forward.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::evaluation {
namespace {

// Axes 2 and 3 of the Puma are parallel, all other neighbours stand upright on each other.
TEST(DrawnAxes, of_the_puma_go_by_the_axis_before) {
  const auto axes = drawn_axes(test::puma560(), Vector3(0.05, 0, 0.1));
  ASSERT_EQ(axes.size(), 6U);
  EXPECT_EQ(axes[0].heading, Heading::kToTool);
  for (std::size_t i = 1; i < axes.size(); ++i) {
    EXPECT_EQ(axes[i].other, i - 1);
    EXPECT_EQ(axes[i].heading, i == 2 ? Heading::kAwayFromAxis : Heading::kAlongAxis) << i;
  }
}

// With all joints at zero the tool stands at p_0T; the first axis is z of the base.
TEST(DrawnAxes, first_one_heads_for_the_tool) {
  const Arm puma = test::puma560();
  const Vector3 p_nT(0.05, 0, 0.1);
  const Vector3 p_0T =
      *kinematics::forward(kinematics::make_chain(puma.joints), JointVector(6)) * p_nT;
  const Matrix3 R = drawn_axes(puma, p_nT)[0].X_before.R;
  EXPECT_LT((R.col(0) - Vector3(p_0T.x(), p_0T.y(), 0).normalized()).norm(), 1e-12);
  EXPECT_LT((R.col(2) - Vector3::UnitZ()).norm(), 1e-12);
}

}  // namespace
}  // namespace armsig::evaluation
