// SPDX-License-Identifier: MIT
// The signature that a drawing predicts, and what is still like its drawing.
#include <vector>

#include <gtest/gtest.h>

#include "firmware/analysis/starts/start.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Log;
using test::Random;

// The readings at which drawn_signature() stands, for a log of these.
JointVector middle_of(const std::vector<std::array<double, 6>>& readings) {
  Log log;
  for (const std::array<double, 6>& q : readings) {
    Observation row;
    for (const double reading : q) row.readings.push_back(reading);
    log.push_back(row);
  }
  BaseAndTool fitted;
  fitted.p_LT.push_back(Vector3::Zero());
  const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
  return drawn_signature(test::puma(), fitted, log, targets).configuration;
}

void expect_readings(const JointVector& found, const std::array<double, 6>& expected) {
  ASSERT_EQ(found.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(found[i], expected[i]) << i;
}

// The mean is zero. Joint 2 goes three times as far as joint 1, and a quarter of its way is nearer
// than half of joint 1's. The others rest, one of them far from zero.
TEST(DrawnSignature, stands_at_the_row_nearest_to_the_middle_of_what_each_joint_did) {
  const double rest = 0.7;
  expect_readings(middle_of({{0.4, 0, 0, rest, 0, 0},
                             {-0.4, 0, 0, rest, 0, 0},
                             {0.2, 0, 0, rest, 0, 0},
                             {-0.2, 0.3, 0, rest, 0, 0},
                             {0, 1.2, 0, rest, 0, 0},
                             {0, -1.2, 0, rest, 0, 0},
                             {0, -0.3, 0, rest, 0, 0}}),
                  {0, -0.3, 0, rest, 0, 0});
}

// About a mean far from zero, and different for each joint.
TEST(DrawnSignature, stands_in_the_middle_of_motions_of_any_size) {
  expect_readings(middle_of({{1.02, 0, 0, 0, -2, 3},
                             {0.98, 0, 0, 0, -2, -3},
                             {1.005, 0, 0, 0, -2, 1},
                             {0.985, 0, 0, 0, -2, -0.5},
                             {1.01, 0, 0, 0, -2, -0.5}}),
                  {1.005, 0, 0, 0, -2, 1});
  expect_readings(middle_of({{-1.3, 1.02, 0, 0, 0, 0},
                             {-0.7, 0.98, 0, 0, 0, 0},
                             {-1.1, 0.99, 0, 0, 0, 0},
                             {-0.95, 1.01, 0, 0, 0, 0},
                             {-0.95, 1.0, 0, 0, 0, 0}}),
                  {-0.95, 1.0, 0, 0, 0, 0});
}

TEST(LikeItsDrawing, refuses_a_twist_between_neighbours_that_nobody_builds) {
  Random random(81);
  const test::Cell cell = test::puma_cell(random, {0, 0, 0});
  const Signature drawn = test::signature_of(cell, test::cell_configuration());
  EXPECT_TRUE(like_its_drawing(drawn, drawn, {}));
  for (std::size_t joint = 0; joint < 5; ++joint) {
    test::Cell bent = cell;
    bent.arm.joints[joint].alpha_rad += radians(9);
    Signature found = test::signature_of(bent, test::cell_configuration());
    EXPECT_TRUE(like_its_drawing(drawn, found, {})) << joint;
    bent.arm.joints[joint].alpha_rad += radians(3);
    found = test::signature_of(bent, test::cell_configuration());
    const auto judged = like_its_drawing(drawn, found, {});
    const Refusal refusal = test::failure_of(judged);
    EXPECT_EQ(refusal.error, Error::kNotConverged);
    EXPECT_NEAR(refusal.found, radians(12), 1e-9) << joint;
    EXPECT_DOUBLE_EQ(refusal.needed, radians(10));
  }
}

}  // namespace
}  // namespace armsig::calibration
