// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/unmeasured.hpp"

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

calibration::ArmModel measured_between(std::initializer_list<JointLimits> limits) {
  calibration::ArmModel model;
  for (const JointLimits& covered : limits) {
    calibration::JointModel joint;
    joint.covered = covered;
    model.joints.push_back(joint);
  }
  return model;
}

std::vector<calibration::Observation> rows_at(
    std::initializer_list<std::pair<double, double>> all) {
  std::vector<calibration::Observation> rows;
  for (const auto& [q1, q2] : all) {
    calibration::Observation row;
    row.readings = {q1, q2};
    rows.push_back(row);
  }
  return rows;
}

TEST(Unmeasured, names_the_joint_that_reads_elsewhere_and_where) {
  const calibration::ArmModel model = measured_between({{-1, 1}, {0.2, 0.2}});
  const auto found = unmeasured_joints(&model, rows_at({{0, 0.2}, {0.5, -0.5}, {1, 0.6}}));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(in_words(found[0]),
            "joint 2 reads -28.648° to 34.377°, and the signature was measured from 11.459° to "
            "11.459°");
}

TEST(Unmeasured, allows_five_degrees_and_a_tenth_of_the_rows) {
  const calibration::ArmModel model = measured_between({{-1, 1}, {0, 0.1}});
  std::vector<calibration::Observation> rows = rows_at({{1 + radians(4.9), 0}, {-1.08, 0.15}});
  EXPECT_TRUE(unmeasured_joints(&model, rows).empty());
  rows.resize(10, rows[0]);
  rows[3].readings[0] = 2;
  EXPECT_TRUE(unmeasured_joints(&model, rows).empty());
  rows[4].readings[0] = -2;
  EXPECT_EQ(unmeasured_joints(&model, rows).size(), 1U);
}

TEST(Unmeasured, says_nothing_where_nobody_noted_what_was_measured) {
  const calibration::ArmModel model = measured_between({{0, 0}, {0, 0}});
  const auto rows = rows_at({{1, 1}, {2, 2}});
  EXPECT_TRUE(unmeasured_joints(&model, rows).empty());
  EXPECT_TRUE(unmeasured_joints(nullptr, rows).empty());
}

}  // namespace
}  // namespace armsig::tool
