// SPDX-License-Identifier: MIT
// The frames in which an arm's axes are said to depart from the drawing.
#include <gtest/gtest.h>

#include "core/kinematics/forward.hpp"
#include "firmware/analysis/differences/drawn_axes.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::differences {
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

// A centimetre is no link: parallel axes so near say nothing of where the joint's zero is.
TEST(DrawnAxes, parallel_ones_tell_the_zero_by_a_link_between_them) {
  for (const double apart_m : {0.01, 0.3}) {
    const Arm arm = test::make_arm({{test::kR, 0, 0, apart_m, 0}, {test::kR, 0, 0, 0.2, 0}},
                                   {{-3, 3}, {-3, 3}});
    const auto axes = drawn_axes(arm, Vector3(0.1, 0, 0));
    EXPECT_EQ(axes[1].heading, Heading::kAwayFromAxis) << apart_m;
    EXPECT_EQ(axes[1].of_zero == Deviation::kShiftY, apart_m > 0.1) << apart_m;
  }
}

}  // namespace
}  // namespace armsig::differences
