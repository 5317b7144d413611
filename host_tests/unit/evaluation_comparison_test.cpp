// SPDX-License-Identifier: MIT
// The grid-touching task with drawing and with signature, and how far a model misses over the whole
// joint space.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/analysis/evaluation/comparison.hpp"
#include "firmware/analysis/evaluation/tool_error.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::evaluation {
namespace {

using test::Random;

constexpr Grid kSmallGrid{.size_m = {0.1, 0.1, 0.2}, .count = {2, 2, 3}};

struct Compared {
  Arm drawing = test::puma();
  Arm arm;
  Pose X_S0;
  JointVector configuration = test::cell_configuration();

  explicit Compared(std::uint64_t seed) {
    Random random(seed);
    arm = test::made_to(drawing, {}, random);
    X_S0 = {random.rotation(), random.direction()};
  }
  // What an exact identification gives, the tool being target `number`; no tool for 0.
  [[nodiscard]] Signature exact(int number) const {
    const KnownTarget tool{number, number == 0 ? 0U : 6U, Vector3(0.05, 0.02, 0.1)};
    return signature_of(arm, configuration, X_S0, {&tool, 1});
  }
};

TEST(Compare, finds_the_exact_signature_better_than_the_drawing) {
  const Compared arm(81);
  const auto found = compare(arm.drawing, arm.exact(1), arm.exact(1), kSmallGrid);
  ASSERT_TRUE(found);
  EXPECT_GT(found->ideal.radial_deviation_m, 2e-4);
  EXPECT_LT(found->with_signature.radial_deviation_m, 5e-5);
  EXPECT_EQ(found->grid.size_m, kSmallGrid.size_m);
}

// Taken at other readings, and in another frame, the truth is the same arm.
TEST(Compare, takes_the_truth_at_the_readings_of_the_signature) {
  const Compared arm(82);
  Compared elsewhere = arm;
  for (double& reading : elsewhere.configuration) reading += 0.2;
  elsewhere.X_S0 = {rotation_z(1.0), Vector3(0.3, 0.2, 0.1)};
  const auto here = compare(arm.drawing, arm.exact(1), arm.exact(1), kSmallGrid);
  const auto found = compare(arm.drawing, arm.exact(1), elsewhere.exact(1), kSmallGrid);
  ASSERT_TRUE(here);
  ASSERT_TRUE(found);
  EXPECT_LT(found->with_signature.radial_deviation_m, 5e-5);
  EXPECT_NEAR(found->ideal.radial_deviation_m, here->ideal.radial_deviation_m, 5e-5);
}

TEST(Compare, takes_the_tool_of_the_signature_where_the_truth_has_none_of_its_number) {
  const Compared arm(83);
  for (const int number : {0, 2}) {
    const auto found = compare(arm.drawing, arm.exact(1), arm.exact(number), kSmallGrid);
    ASSERT_TRUE(found) << number;
    EXPECT_LT(found->with_signature.radial_deviation_m, 5e-5) << number;
  }
}

TEST(Compare, takes_the_drawings_last_frame_where_the_signature_has_no_tool) {
  const Compared arm(84);
  const auto found = compare(arm.drawing, arm.exact(0), arm.exact(1), kSmallGrid);
  ASSERT_TRUE(found);
  EXPECT_LT(found->with_signature.radial_deviation_m, 5e-5);
}

TEST(Compare, refuses_a_drawing_in_whose_limits_no_grid_fits) {
  Compared arm(85);
  for (std::size_t j = 0; j < 6; ++j) {
    arm.drawing.limits[j] = {arm.configuration[j] - 1e-3, arm.configuration[j] + 1e-3};
  }
  const auto found = compare(arm.drawing, arm.exact(1), arm.exact(1), kSmallGrid);
  ASSERT_FALSE(found);
  EXPECT_EQ(test::failure_of(found), Error::kOutOfReach);
}

// The drawing takes joint 4 through angles that the signature's offset puts beyond the limits.
TEST(Compare, refuses_a_signature_that_does_not_reach_what_the_drawing_does) {
  Compared arm(86);
  arm.arm.joints[1].a_m = 0.1;
  const auto found = compare(arm.drawing, arm.exact(1), arm.exact(1),
                             Grid{.size_m = {0.6, 0.6, 0.6}, .count = {2, 2, 2}});
  ASSERT_FALSE(found);
  EXPECT_EQ(test::failure_of(found), Error::kOutOfReach);
}

TEST(Improvement, is_the_ratio_of_the_indices_and_counts_at_least_half_a_step) {
  Comparison compared;
  compared.grid.size_m = {0.1, 0.5, 0.2};
  compared.ideal = {2e-3, 4e-3, 6e-3, 8e-3};
  compared.with_signature = {1e-3, 0, 2e-3, 0};
  const auto factors = improvement(compared, {.position_m = 1e-3, .angle_rad = 4e-3});
  EXPECT_DOUBLE_EQ(factors[0], 2);
  EXPECT_DOUBLE_EQ(factors[1], 4e-3 / (1e-3 / 0.5 / 2));  // one step over the longest edge, halved
  EXPECT_DOUBLE_EQ(factors[2], 3);
  EXPECT_DOUBLE_EQ(factors[3], 4);
}

TEST(ToolError, of_the_arm_itself_is_none_and_of_the_drawing_that_of_its_tolerances) {
  const Compared arm(87);
  Signature truth = arm.exact(1);
  truth.targets.push_back(truth.targets[0]);
  truth.targets[0].number = 3;  // another one, elsewhere
  truth.targets[0].p_S += Vector3(1, 1, 1);
  const double of_itself = rms_tool_error(truth, truth, 1, Pose{}, arm.drawing.limits, 50);
  EXPECT_LT(of_itself, 1e-12);
  const Signature drawn = drawing_as_model(arm.drawing, truth);
  const double of_drawing = rms_tool_error(drawn, truth, 1, Pose{}, arm.drawing.limits, 50);
  EXPECT_GT(of_drawing, 0.5e-3);
  EXPECT_LT(of_drawing, 10e-3);
}

TEST(ToolError, counts_by_how_much_the_models_frame_is_off) {
  const Compared arm(88);
  const Signature truth = arm.exact(1);
  const Pose X_AM{Matrix3::Identity(), Vector3(0.003, 0, 0.004)};
  EXPECT_NEAR(rms_tool_error(truth, truth, 1, X_AM, arm.drawing.limits, 20), 0.005, 1e-9);
}

}  // namespace
}  // namespace armsig::evaluation
