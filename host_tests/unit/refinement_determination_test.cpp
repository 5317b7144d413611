// SPDX-License-Identifier: MIT
// What the rows alone tell, and what is named because they do not.
#include <algorithm>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/analysis/starts/determination.hpp"
#include "host_tests/support/calibration_case.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Log;
using test::Random;

constexpr double kSigma = 0.2e-3;

// The arm of `cell` from its log, with the corrections of `request` among the unknowns.
std::unique_ptr<Refined> named(const Cell& cell, const Log& log,
                               const ParameterRequest& request = {}) {
  auto refined = std::make_unique<Refined>();
  refined->signature = test::signature_of(cell, test::cell_configuration());
  if (!request.readings.empty()) refined->readings.corrections.resize(6);
  const auto layout = make_layout(refined->signature, {true}, request, 0);
  EXPECT_TRUE(layout);
  if (!layout) return refined;
  refined->layout = *layout;
  const std::vector<RowOutcome> outcomes(log.size());
  const auto alone = std::make_unique<RowsAlone>();
  gather_rows(log, outcomes, {}, kSigma, *refined, *alone);
  name_undetermined(*alone, *refined);
  return refined;
}

TEST(Determination, of_poses_anywhere_leaves_nothing_open) {
  Random random(12);
  const Cell cell = test::puma_cell(random);
  Log log;
  test::add_poses(cell, 60, kSigma, random, log);
  EXPECT_TRUE(named(cell, log)->undetermined.empty());
}

TEST(Determination, names_the_joint_whose_axis_carries_the_target) {
  Random random(13);
  Cell cell = test::puma_cell(random);
  cell.p_tool[0] = Vector3(0, 0, 0.1);
  Log log;
  test::add_poses(cell, 60, kSigma, random, log);
  const auto refined = named(cell, log);
  ASSERT_EQ(refined->undetermined.size(), 1U);
  EXPECT_EQ(refined->undetermined[0].open, Open::kTargetOnAxis);
  EXPECT_EQ(refined->undetermined[0].index, 5U);
}

TEST(Determination, names_a_joint_that_rested) {
  Random random(14);
  const Cell cell = test::puma_cell(random);
  Log log;
  for (int k = 0; k < 60; ++k) {
    JointVector q = random.configuration(cell.arm);
    q[3] = test::cell_configuration()[3];
    log.push_back(test::observe(cell, q, 0, kSigma, random));
  }
  const auto refined = named(cell, log);
  ASSERT_EQ(refined->undetermined.size(), 1U);
  EXPECT_EQ(refined->undetermined[0].open, Open::kJointAtRest);
  EXPECT_EQ(refined->undetermined[0].index, 3U);
}

TEST(Determination, names_the_gain_of_a_joint_that_hardly_moved) {
  Random random(15);
  const Cell cell = test::puma_cell(random);
  Log log;
  for (int k = 0; k < 60; ++k) {
    JointVector q = random.configuration(cell.arm);
    q[5] = test::cell_configuration()[5] + random.uniform(-0.1, 0.1);
    log.push_back(test::observe(cell, q, 0, kSigma, random));
  }
  ParameterRequest request;
  request.readings.resize(6, ReadingTerms{.gain = true});
  const auto refined = named(cell, log, request);
  std::size_t gains = 0;
  for (const Undetermined& open : refined->undetermined) {
    if (open.open != Open::kReadingGain) continue;
    ++gains;
    EXPECT_EQ(open.index, 5U);
  }
  EXPECT_EQ(gains, 1U);
}

TEST(Determination, asks_only_rows_that_are_fitted_and_not_rejected) {
  Random random(16);
  const Cell cell = test::puma_cell(random);
  Log log;
  test::add_poses(cell, 60, kSigma, random, log);
  std::vector<RowOutcome> outcomes(log.size());
  const auto refined = named(cell, log);
  for (std::size_t k = 0; k < log.size(); ++k) {
    if (k % 2 == 0) {
      outcomes[k].rejected = true;
    } else {
      log[k].use = RowUse::kIgnore;
    }
  }
  const auto alone = std::make_unique<RowsAlone>();
  gather_rows(log, outcomes, {}, kSigma, *refined, *alone);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_EQ(alone->motion[j], 0);
}

TEST(Determination, names_anew_what_later_rows_leave_open) {
  Random random(17);
  const Cell cell = test::puma_cell(random);
  Log log;
  const auto refined = named(cell, log);
  EXPECT_EQ(refined->undetermined.size(), 7U);  // six axes and the target
  test::add_poses(cell, 60, kSigma, random, log);
  const std::vector<RowOutcome> outcomes(log.size());
  const auto alone = std::make_unique<RowsAlone>();
  gather_rows(log, outcomes, {}, kSigma, *refined, *alone);
  name_undetermined(*alone, *refined);
  EXPECT_TRUE(refined->undetermined.empty());
}

// An unknown scale is an error of the fit, not an entry of a list.
TEST(Determination, never_names_the_scale) {
  Refined refined;
  Random random(18);
  refined.signature = test::signature_of(test::puma_cell(random), test::cell_configuration());
  ParameterRequest request;
  request.scale = true;
  const auto layout = make_layout(refined.signature, {false}, request, 0);
  ASSERT_TRUE(layout);
  refined.layout = *layout;
  RowsAlone alone;
  gather_rows({}, {}, {}, kSigma, refined, alone);
  name_undetermined(alone, refined);
  EXPECT_EQ(refined.undetermined.size(), 6U);
  for (const Undetermined& open : refined.undetermined) EXPECT_EQ(open.open, Open::kJointAtRest);
}

TEST(Determination, names_every_correction_that_no_row_tells) {
  Random random(19);
  Refined refined;
  refined.signature = test::signature_of(test::puma_cell(random), test::cell_configuration());
  refined.readings.corrections.resize(6);
  ParameterRequest request;
  request.readings.resize(6, ReadingTerms{.gain = true, .first = true, .second = true});
  request.receiver_offsets = true;
  const auto layout = make_layout(refined.signature, {false}, request, 3);
  ASSERT_TRUE(layout);
  refined.layout = *layout;
  RowsAlone alone;
  gather_rows({}, {}, {}, kSigma, refined, alone);
  name_undetermined(alone, refined);
  const auto named_of = [&](Open open) {
    return std::count_if(refined.undetermined.begin(), refined.undetermined.end(),
                         [&](const Undetermined& one) { return one.open == open; });
  };
  EXPECT_EQ(named_of(Open::kReadingGain), 6);
  EXPECT_EQ(named_of(Open::kReadingFirst), 6);
  EXPECT_EQ(named_of(Open::kReadingSecond), 6);
  EXPECT_EQ(named_of(Open::kReceiverOffset), 3);
}

// A thousandth of a radian tells by the noise that it moved, and of its axis nothing.
TEST(Determination, names_direction_and_place_of_an_axis_about_which_little_turned) {
  Random random(20);
  Cell cell = test::puma_cell(random);
  for (const bool on_axis : {false, true}) {
    if (on_axis) cell.p_tool[0] = Vector3(1e-3, 0, 0.1);
    const std::size_t joint = on_axis ? 5 : 2;
    Log log;
    for (int k = 0; k < 60; ++k) {
      JointVector q = random.configuration(cell.arm);
      q[joint] = test::cell_configuration()[joint] + random.uniform(-1e-3, 1e-3);
      log.push_back(test::observe(cell, q, 0, kSigma, random));
    }
    const auto refined = named(cell, log);
    std::vector<Open> open;
    for (const Undetermined& one : refined->undetermined) {
      if (one.index == joint) open.push_back(one.open);
    }
    EXPECT_EQ(open, on_axis ? std::vector{Open::kTargetOnAxis}
                            : (std::vector{Open::kAxisDirection, Open::kAxisPosition}));
  }
}

}  // namespace
}  // namespace armsig::calibration
