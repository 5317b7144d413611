// SPDX-License-Identifier: MIT
// Which rows are one pose, and which poses are held out together.
#include <array>
#include <vector>

#include <gtest/gtest.h>

#include "core/calibration/fit_row.hpp"
#include "host_tests/support/random.hpp"

namespace armsig::calibration {
namespace {

using test::Random;

const std::vector<JointType> kTwoJoints(2, JointType::kRevolute);

FitRow row_at(double first, double second, const Vector3& p_S, std::uint32_t index) {
  FitRow row;
  row.readings = JointVector{first, second};
  row.p_S = p_S;
  row.index = index;
  return row;
}

TEST(GroupPoses, sorts_repeats_that_differ_along_one_axis_alone) {
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Vector3 farther(0.1, 0.2, 0.3);
    farther[axis] += 1e-5;
    std::vector<FitRow> rows{row_at(0.5, 0.2, farther, 1),
                             row_at(0.5, 0.2, Vector3(0.1, 0.2, 0.3), 0)};
    group_poses(rows, kTwoJoints);
    EXPECT_EQ(rows[0].index, 0U) << axis;
    EXPECT_EQ(rows[1].index, 1U) << axis;
  }
}

TEST(GroupPoses, sorts_the_ranges_of_a_pose_by_their_receivers) {
  std::vector<FitRow> rows;
  for (const std::uint8_t receiver : std::array<std::uint8_t, 4>{2, 0, 3, 1}) {
    rows.push_back(row_at(0.5, 0.2, Vector3::Zero(), receiver));
    rows.back().receiver = receiver;
    rows.back().range_m = 2 - 0.1 * receiver;
  }
  group_poses(rows, kTwoJoints);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(rows[k].receiver, k);
}

// Sorted by the first reading, the other pose comes between the two.
TEST(GroupPoses, joins_repeats_around_a_reading_of_another_pose) {
  const double little = radians(0.002);
  std::vector<FitRow> rows{row_at(0.5, 0.2, Vector3::Zero(), 0),
                           row_at(0.5 + little, 1.4, Vector3::Zero(), 1),
                           row_at(0.5 + 2 * little, 0.2, Vector3::Zero(), 0)};
  group_poses(rows, kTwoJoints);
  std::vector<std::uint32_t> poses(2);
  for (const FitRow& row : rows) poses[row.index] = row.pose;
  EXPECT_NE(poses[0], poses[1]);
  for (const FitRow& row : rows) EXPECT_EQ(row.pose, poses[row.index]);
}

// What lies in a row must not be held out in turns: a model between two neighbours is no judge.
TEST(DealFolds, deals_poses_along_a_line_by_chance) {
  std::vector<FitRow> rows;
  for (std::uint32_t k = 0; k < 100; ++k) rows.push_back(row_at(0.02 * k, 0.3, Vector3::Zero(), k));
  group_poses(rows, kTwoJoints);
  ASSERT_EQ(deal_folds(rows), 100U);
  std::vector<std::uint8_t> folds(100);
  for (const FitRow& row : rows) folds[row.index] = row.fold;
  int same_as_five_before = 0;
  for (std::size_t k = kFolds; k < 100; ++k) same_as_five_before += folds[k] == folds[k - kFolds];
  EXPECT_LT(same_as_five_before, 40);
}

TEST(DealFolds, always_fits_the_sweeps_where_there_are_poses_enough) {
  Random random(8);
  std::vector<FitRow> rows;
  for (std::uint32_t k = 0; k < 40; ++k) {
    rows.push_back(row_at(random.uniform(-2, 2), random.uniform(-2, 2), Vector3::Zero(), k));
    rows.back().sweep = k < 20 ? 1 : 0;
  }
  group_poses(rows, kTwoJoints);
  EXPECT_EQ(deal_folds(rows), 20U);
  for (const FitRow& row : rows) {
    if (row.sweep == 1) {
      EXPECT_EQ(row.fold, kNoFold);
    } else {
      EXPECT_LT(row.fold, kFolds);
    }
  }
}

}  // namespace
}  // namespace armsig::calibration
