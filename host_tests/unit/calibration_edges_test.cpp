// SPDX-License-Identifier: MIT
// The estimator where rows, poses or memory are few or many, and where rows are of mixed kinds.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/calibration/servo_readings.hpp"
#include "host_tests/support/engine_case.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::EngineCase;
using test::kGeometryAlone;
using test::kRowSigma_m;
using test::position_rows;
using test::Random;

Cell two_target_cell(Random& random) {
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.p_tool = {Vector3(0.1, 0, 0.1), Vector3(-0.1, 0.1, 0.1)};
  return cell;
}

TEST(EngineMemory, is_saved_where_frames_are_evaluated_anew) {
  Random random(101);
  const Cell cell = test::puma_cell(random);
  const auto rows = position_rows(cell, 60, kRowSigma_m, random);
  EngineCase kept(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  EngineCase anew(test::puma(), cell.X_SB, {cell.p_tool[0]}, rows);
  const Problem problem = anew.problem();
  Engine engine(problem.model, problem.targets, problem.rows, {}, problem.matrix, problem.work);
  ASSERT_TRUE(kept.engine().run({.gravity = false, .maps = true}));
  ASSERT_TRUE(engine.run({.gravity = false, .maps = true}));
  const JointVector q = random.configuration(cell.arm);
  EXPECT_LT((kept.predict(q) - anew.predict(q)).norm(), 1e-12);
}

TEST(EngineSequence, has_nothing_left_to_do_once_it_is_over) {
  Random random(102);
  const Cell cell = test::puma_cell(random);
  EngineCase fit(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 position_rows(cell, 30, kRowSigma_m, random));
  ASSERT_TRUE(fit.engine().run(kGeometryAlone));
  EXPECT_FALSE(fit.engine().step(1));
  EXPECT_TRUE(fit.engine().result());
}

// A step may end between the rows of a pose: they are judged together all the same.
TEST(Outliers, of_a_pose_are_judged_together_however_the_work_is_cut) {
  Random random(103);
  const Cell cell = two_target_cell(random);
  std::vector<FitRow> rows = position_rows(cell, 60, kRowSigma_m, random);
  for (std::size_t k = 0; k < 2; ++k) rows[k].p_S += Vector3(0.02, 0, 0);  // the arm, not a blunder
  EngineCase whole(cell.arm, cell.X_SB, cell.p_tool, rows);
  EngineCase cut(cell.arm, cell.X_SB, cell.p_tool, rows);
  ASSERT_TRUE(whole.engine().run(kGeometryAlone));
  cut.engine().begin(kGeometryAlone);
  while (cut.engine().step(1)) {
  }
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(cut.rows[k].weight, whole.rows[k].weight) << k;
    EXPECT_GT(whole.rows[k].weight, 0) << k;
  }
}

// So many rows of one pose are each judged alone: what they have in common would take too long.
TEST(Outliers, of_a_pose_of_very_many_rows_are_judged_one_by_one) {
  Random random(104);
  const Cell cell = two_target_cell(random);
  for (const int repeats : {20, 40}) {
    std::vector<FitRow> rows = position_rows(cell, 400, kRowSigma_m, random);
    const JointVector q = random.configuration(cell.arm);
    for (int k = 0; k < 2 * repeats; ++k) {
      const auto target = static_cast<std::uint8_t>(k % 2);
      const Vector3 noise = random.normal_vector(kRowSigma_m);
      rows.push_back(
          test::position_row(q, cell.point(q, target) + Vector3(0.02, 0, 0) + noise, target));
    }
    EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, rows);
    const auto summary = fit.engine().run(kGeometryAlone);
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->rejected, repeats == 20 ? 0U : 80U);
  }
}

// Its rows contradict each other by a metre: without them nothing would be known of it.
TEST(Outliers, leave_a_target_the_rows_that_it_would_lose_all) {
  Random random(105);
  const Cell cell = two_target_cell(random);
  std::vector<FitRow> rows;
  for (int k = 0; k < 60; ++k) {
    const JointVector q = random.configuration(cell.arm);
    rows.push_back(test::position_row(q, cell.point(q, 0) + random.normal_vector(kRowSigma_m)));
  }
  const JointVector q = random.configuration(cell.arm);
  for (const double off_m : {-0.5, 0.5}) {
    rows.push_back(test::position_row(q, cell.point(q, 1) + Vector3(off_m, 0, 0), 1));
  }
  EngineCase fit(cell.arm, cell.X_SB, cell.p_tool, rows);
  const auto summary = fit.engine().run(kGeometryAlone);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->rejected, 0U);
  for (const FitRow& row : fit.rows) EXPECT_EQ(row.weight, 1);
}

// Positions and ranges together, of targets on two links: joints beyond a link tell nothing of it.
TEST(Engine, finds_offset_and_scale_of_a_sensor_from_rows_of_both_kinds) {
  constexpr double kOffset_m = 2e-3;
  constexpr double kScale = 1e-3;
  Random random(106);
  Cell cell = test::puma_cell(random, {0, 0, 0});
  cell.arm.joints[5].d_m = 0.1;  // so that gravity has levers behind link 3
  const Vector3 p_on_link_3(0.1, 0.05, 0.1);
  const std::array<Vector3, 2> receivers{Vector3(2, 0, 0), Vector3(0, 2, 1)};
  std::vector<FitRow> rows;
  for (int k = 0; k < 200; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const auto target = static_cast<std::uint8_t>(k % 3 == 0);
    const Vector3 p_S = target == 0 ? cell.point(q, 0) : cell.frame(q, 3) * p_on_link_3;
    if (k % 2 == 0) {
      rows.push_back(
          test::position_row(q, (1 + kScale) * p_S + random.normal_vector(1e-5), target));
      continue;
    }
    const auto receiver = static_cast<std::uint8_t>(k / 2 % 2);
    rows.push_back(test::range_row(q, receiver,
                                   (1 + kScale) * (p_S - receivers[receiver]).norm() +
                                       (receiver == 1 ? kOffset_m : 0) + random.normal(1e-5)));
    rows.back().target = target;
  }
  EngineCase fit(cell.arm, cell.X_SB, {cell.p_tool[0], p_on_link_3}, rows);
  fit.targets[1].link = 3;
  for (const Vector3& receiver : receivers) fit.model->sensor.receivers.push_back(receiver);
  ParameterRequest request;
  request.readings.resize(6, {.gain = true});
  request.receiver_offsets = true;
  request.scale = true;
  ask_for(request, *fit.model);
  choose_gravity_terms(cell.arm, *fit.model);
  ASSERT_TRUE(fit.engine().run({.gravity = true, .maps = false}));
  EXPECT_NEAR(fit.model->sensor.offset_m[1] - fit.model->sensor.offset_m[0], kOffset_m, 1e-4);
  EXPECT_NEAR(fit.model->sensor.scale, kScale, 2e-4);
}

TEST(HeldOut, says_nothing_of_one_pose_and_no_region_of_a_few) {
  Random random(107);
  const Cell cell = test::puma_cell(random);
  EngineCase one(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 position_rows(cell, 1, kRowSigma_m, random));
  const auto nothing = one.held_out(kGeometryAlone);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->rows, 0U);
  EXPECT_EQ(nothing->factor, 1);
  EXPECT_EQ(nothing->rms_kept_m, 0) << "and not nought by nought";
  EngineCase few(test::puma(), cell.X_SB, {cell.p_tool[0]},
                 position_rows(cell, 4, kRowSigma_m, random));
  const auto some = few.held_out(kGeometryAlone);
  ASSERT_TRUE(some);
  EXPECT_EQ(some->rows, 4U);
  EXPECT_EQ(some->region_squares, 0) << "95 % of four rows are all of them";
}

TEST(GroupPoses, sorts_ranges_that_differ_in_nothing_but_length_and_sweep) {
  std::vector<FitRow> rows;
  for (const std::uint32_t index : {2U, 0U, 3U, 1U}) {
    rows.push_back(test::range_row({0.5, 0.2}, 0, index < 2 ? 1.0 : 2.0));
    rows.back().sweep = static_cast<std::uint8_t>(index % 2);
    rows.back().index = index;
  }
  const std::vector<JointType> types{JointType::kRevolute, JointType::kPrismatic};
  group_poses(rows, types);
  for (std::uint32_t k = 0; k < 4; ++k) EXPECT_EQ(rows[k].index, k);
}

TEST(GroupPoses, takes_slides_for_at_rest_by_lengths) {
  const std::vector<JointType> slide{JointType::kPrismatic};
  for (const double apart_m : {0.04e-3, 0.06e-3}) {
    std::vector<FitRow> rows{test::position_row({0.1}, Vector3::Zero()),
                             test::position_row({0.1 + apart_m}, Vector3::Zero())};
    group_poses(rows, slide);
    EXPECT_EQ(rows[0].pose == rows[1].pose, apart_m < 0.05e-3) << apart_m;
  }
}

TEST(ServoReadings, of_no_deflections_say_everything) {
  ServoReadings joints;
  joints.set({}, test::puma(), JointVector(6, 0.0));
  EXPECT_TRUE(joints.exact());
}

// A configuration that is no number is refused where it is first turned, not where it is set.
TEST(ServoReadings, at_a_configuration_that_is_no_number_turn_from_nought) {
  ArmModel model = model_of(test::puma(), {});
  for (JointModel& joint : model.joints) joint.map.fill(2);
  const PackedDeflections deflections = packed(model);
  const ServoReadings wrong(deflections, test::puma(),
                            JointVector(6, std::numeric_limits<double>::quiet_NaN()));
  const auto turned = wrong.turned(JointVector(6, 0.3));
  ASSERT_TRUE(turned);
  EXPECT_NEAR((*turned)[2], 0.3 + 2 * map_unit(JointType::kRevolute), 1e-7);
}

TEST(ServoReadings, of_a_slide_without_limits_are_as_of_one_with) {
  Arm arm = test::puma();
  arm.joints[2].type = JointType::kPrismatic;
  arm.limits[2] = {-0.3, 0.3};
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  for (GravityTerm& term : model.gravity) term.coefficient = 1e-4;
  const PackedDeflections deflections = packed(model);
  Arm unlimited = arm;
  unlimited.limits.clear();
  const JointVector at_rest(6, 0.1);
  const ServoReadings with(deflections, arm, at_rest);
  const ServoReadings without(deflections, unlimited, at_rest);
  const JointVector q{0.4, -0.7, 0.2, 0.3, 0.5, 0.1};
  const auto a = with.readings(q);
  const auto b = without.readings(q);
  ASSERT_TRUE(a);
  ASSERT_TRUE(b);
  for (std::size_t j = 0; j < 6; ++j) EXPECT_NEAR((*a)[j], (*b)[j], 1e-7) << j;
}

}  // namespace
}  // namespace armsig::calibration
