// SPDX-License-Identifier: MIT
// What is suspected of the readings where a drawing does not explain a log.
#include <cmath>

#include <gtest/gtest.h>

#include "firmware/analysis/starts/reading_suspicion.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Log;
using test::Random;

// Poses of an arm that is its drawing but for couplings.
Log poses_of(const JointCouplings& couplings, Random& random) {
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.arm.couplings = couplings;
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  return log;
}

std::optional<ReadingSuspicion> suspected(const Arm& drawing, const Log& log) {
  const std::array<Target, 1> targets{Target{.number = 1, .link = 6}};
  return suspect_readings(drawing, log, targets);
}

TEST(ReadingSuspicion, finds_a_coupling_of_any_ratio_near_one) {
  Random random(91);
  for (const double ratio : {-1.0, 0.8, 1.2, -0.75}) {
    const auto found = suspected(test::puma(), poses_of({{2, 1, ratio}}, random));
    ASSERT_TRUE(found) << ratio;
    EXPECT_EQ(found->coupling.joint, 2U);
    EXPECT_EQ(found->coupling.from, 1U);
    EXPECT_NEAR(found->coupling.ratio, ratio, 1e-3);
    EXPECT_LT(found->rms_m, 1e-3);
    EXPECT_GT(found->plain_rms_m, 0.01);
  }
}

// No row tells what follows a joint that stood still, nor what one that did follows.
TEST(ReadingSuspicion, accuses_no_joint_that_stood_still) {
  Random random(94);
  Cell cell = test::puma_cell(random, {0, 0, 0});
  Log log;
  for (int k = 0; k < 40; ++k) {
    JointVector q = random.configuration(cell.arm);
    for (const std::size_t j : {2U, 3U, 4U, 5U}) q[j] = 0.001 * static_cast<double>(k % 3);
    // Bent by its own weight: no coupling.
    const Vector3 sag(0, 0, -2e-3 * std::cos(q[1]));
    Observation row;
    row.readings = q;
    row.p_S = cell.point(q, 0) + sag;
    log.push_back(row);
  }
  for (const std::size_t j : {2U, 3U, 4U, 5U}) {
    const auto found = suspected(test::puma(), log);
    EXPECT_TRUE(!found || (found->coupling.joint != j && found->coupling.from != j)) << j;
  }
}

TEST(ReadingSuspicion, finds_each_joint_that_turns_against_its_reading) {
  Random random(92);
  for (std::size_t joint = 1; joint < 5; ++joint) {
    const auto found = suspected(test::puma(), poses_of({{joint, joint, -2}}, random));
    ASSERT_TRUE(found) << joint;
    EXPECT_TRUE(found->reversed());
    EXPECT_EQ(found->coupling.joint, joint);
    EXPECT_LT(found->rms_m, 1e-6);
  }
}

// A wrong gain is not a matter of the sense: what is said of a reversed joint stays plain.
TEST(ReadingSuspicion, of_a_reversed_joint_is_its_sense_alone) {
  Random random(93);
  const auto found = suspected(test::puma(), poses_of({{1, 1, -1.98}}, random));
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->reversed());
  EXPECT_EQ(found->coupling.ratio, -2);
}

TEST(ReadingSuspicion, finds_a_coupling_that_only_the_drawing_has) {
  Random random(94);
  Arm drawing = test::puma();
  drawing.couplings.push_back({2, 1, -1});
  const auto found = suspected(drawing, poses_of({}, random));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->coupling.joint, 2U);
  EXPECT_EQ(found->coupling.from, 1U);
  EXPECT_EQ(found->coupling.ratio, 0);
}

TEST(ReadingSuspicion, says_nothing_of_an_arm_like_its_drawing) {
  Random random(95);
  EXPECT_FALSE(suspected(test::puma(), poses_of({}, random)));
}

TEST(ReadingSuspicion, needs_a_log_that_can_be_fitted) {
  EXPECT_FALSE(suspected(test::puma(), {}));
}

// A slide and a turn do not hang on each other.
TEST(ReadingSuspicion, couples_joints_of_one_kind) {
  Random random(96);
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.arm.joints[2].type = JointType::kPrismatic;
  cell.arm.limits[2] = {-0.2, 0.3};
  const Arm drawing = cell.arm;
  cell.arm.couplings.push_back({2, 1, 0.1});
  Log log;
  test::add_poses(cell, 20, 0, random, log);
  const auto found = suspected(drawing, log);
  if (found) {
    EXPECT_EQ(drawing.joints[found->coupling.joint].type,
              drawing.joints[found->coupling.from].type);
  }
  cell.arm.couplings = {{4, 3, -1}};
  log.clear();
  test::add_poses(cell, 20, 0, random, log);
  const auto turning = suspected(drawing, log);
  ASSERT_TRUE(turning);
  EXPECT_EQ(turning->coupling.joint, 4U);
  EXPECT_EQ(turning->coupling.from, 3U);
}

// An arm drawn with as many couplings as there may be is suspected of none more.
TEST(ReadingSuspicion, changes_only_the_couplings_of_a_drawing_that_has_no_room) {
  Random random(97);
  Arm drawing = test::puma();
  for (const auto& [joint, from] : {std::pair<std::size_t, std::size_t>{1, 0},
                                    {2, 0},
                                    {3, 0},
                                    {3, 1},
                                    {4, 0},
                                    {4, 1},
                                    {5, 0},
                                    {5, 1}}) {
    drawing.couplings.push_back({joint, from, 0});
  }
  ASSERT_TRUE(drawing.couplings.full());
  EXPECT_FALSE(suspected(drawing, poses_of({{2, 1, -1}}, random)));
  const auto drawn = suspected(drawing, poses_of({{3, 1, -1}}, random));
  ASSERT_TRUE(drawn);
  EXPECT_EQ(drawn->coupling.joint, 3U);
  EXPECT_EQ(drawn->coupling.from, 1U);
}

}  // namespace
}  // namespace armsig::calibration
