// SPDX-License-Identifier: MIT
// Neighbours of a long log, merged: what is left of them is what a fit needs.
#include "firmware/host_tool/refinement/merged_rows.hpp"

#include <random>

#include <gtest/gtest.h>

#include "host_tests/support/engine_case.hpp"

namespace armsig::tool {
namespace {

using calibration::FitRow;
using calibration::Observation;
using calibration::RowPart;

constexpr double kNoise_m = 5e-5;

FitRow row_of(const Observation& from) {
  FitRow row;
  row.readings = from.readings;
  row.p_S = from.p_S;
  row.sweep = static_cast<std::uint8_t>(from.sweep);
  return row;
}

// A tracker's stream along a straight move in the joints, of 0.1 degrees of the fastest a row. The
// arm deviates from the model of the start by `turned` of every joint's axis.
struct Stream {
  FitStart start;
  calibration::ArmModel truth;
  std::vector<Observation> log;
  std::vector<Sides> sides;
  std::mt19937 random{5};

  explicit Stream(std::size_t rows, double turned = 1e-3) {
    start.model = calibration::model_of(test::puma(), Pose{});
    start.targets.push_back({.link = 6, .p_L = Vector3(0.05, 0.02, 0.1)});
    truth = start.model;
    for (calibration::JointModel& joint : truth.joints) joint.deviation[0] = turned;
    std::normal_distribution<double> noise(0, kNoise_m);
    for (std::size_t k = 0; k < rows; ++k) {
      Observation row;
      for (int j = 0; j < 6; ++j) {
        row.readings.push_back(radians(20.0 * j - 40 + 0.1 / (1 + j) * static_cast<double>(k)));
      }
      row.p_S = position(truth, row.readings);
      for (double& x : row.p_S) x += noise(random);
      log.push_back(row);
    }
    sides.resize(rows);
  }

  [[nodiscard]] Vector3 position(const calibration::ArmModel& model, const JointVector& q) const {
    calibration::ChainFrames frames;
    calibration::evaluate_chain(model, q, 6, frames);
    return frames.X_SL * start.targets[0].p_L;
  }
  [[nodiscard]] RowsToFit gathered() const {
    return merged(log, sides, [this](std::size_t k) { return row_of(log[k]); }, start);
  }
};

TEST(MergedRows, are_two_a_group_and_stand_for_all) {
  const Stream stream(3000);
  const RowsToFit gathered = stream.gathered();
  // 300 degrees of the fastest joint in knots of 3 degrees, and a group less or more at the ends.
  EXPECT_NEAR(static_cast<double>(gathered.rows.size()), 200, 8);
  std::size_t count = 0;
  JointVector mean{0, 0, 0, 0, 0, 0};
  for (const FitRow& row : gathered.rows) {
    count += row.merged.count;
    for (std::size_t j = 0; j < 6; ++j) mean[j] += row.merged.count * row.readings[j] / 3000.0;
  }
  EXPECT_EQ(count, 3000U);
  for (std::size_t j = 0; j < 6; ++j) {
    EXPECT_NEAR(mean[j], 0.5 * (stream.log.front().readings[j] + stream.log.back().readings[j]),
                1e-9);
  }
}

// Also where the model is another than the one that they were merged about.
TEST(MergedRows, give_the_residual_of_every_measured_row) {
  const Stream stream(600);
  const RowsToFit gathered = stream.gathered();
  calibration::ArmModel model = stream.truth;
  for (calibration::JointModel& joint : model.joints) joint.deviation[4] = 1e-3;
  const auto residual = [&](const JointVector& q, const Vector3& p_S) {
    return Vector3(p_S - stream.position(model, q));
  };
  for (std::size_t k = 0; k < stream.log.size(); ++k) {
    const RowPart& part = gathered.parts[k];
    const FitRow& first = gathered.rows[part.first];
    const FitRow& second = gathered.rows[part.share == 0 ? part.first : part.first + 1];
    const Vector3 found = residual_of(part, residual(first.readings, first.p_S),
                                      residual(second.readings, second.p_S));
    const Vector3 expected = residual(stream.log[k].readings, stream.log[k].p_S);
    EXPECT_LT((found - expected).norm(), 2e-6) << k;
  }
}

// What a fit minimises, three numbers a row: sigma, and what the rows of a group are apart.
TEST(MergedRows, keep_the_noise_of_the_rows) {
  const Stream stream(3000);
  double squares = 0;
  for (const FitRow& row : stream.gathered().rows) {
    const Vector3 residual = row.p_S - stream.position(stream.truth, row.readings);
    squares += row.merged.count * residual.squaredNorm() + row.merged.scatter_m2;
  }
  EXPECT_NEAR(std::sqrt(squares / 9000), kNoise_m, 0.03 * kNoise_m);
}

TEST(MergedRows, leave_a_blunder_by_itself) {
  Stream stream(600);
  stream.log[301].p_S += Vector3(0, 5e-3, 0);
  const RowsToFit gathered = stream.gathered();
  const FitRow& blunder = gathered.rows[gathered.parts[301].first];
  EXPECT_EQ(blunder.merged.count, 1U);
  EXPECT_EQ(blunder.p_S, stream.log[301].p_S);
  EXPECT_GT(gathered.rows[gathered.parts[300].first].merged.count, 1U);
}

TEST(MergedRows, end_a_group_where_a_joint_comes_from_the_other_side) {
  Stream stream(600);
  for (std::size_t k = 305; k < 600; ++k) stream.sides[k] = {.sides = 1, .sided = 1};
  const RowsToFit gathered = stream.gathered();
  const std::uint32_t before = gathered.parts[304].first;
  for (std::size_t k = 305; k < 600; ++k) EXPECT_GT(gathered.parts[k].first, before) << k;
}

// Poses that do not neighbour each other are fitted one by one.
TEST(MergedRows, leave_distant_poses_by_themselves) {
  Stream stream(200);
  for (std::size_t k = 0; k < 200; ++k) {
    stream.log[k].readings[k % 6] += radians(10.0 + static_cast<double>(7 * k % 90));
    stream.log[k].p_S = stream.position(stream.truth, stream.log[k].readings);
  }
  EXPECT_EQ(stream.gathered().rows.size(), 200U);
}

TEST(MergedRows, are_left_out_with_all_of_their_group) {
  const Stream stream(3000);
  RowsToFit gathered = stream.gathered();
  calibration::group_poses(gathered.rows, types_of(test::puma().joints));
  join_groups(gathered.rows, gathered.parts);
  calibration::deal_folds(gathered.rows);
  std::vector<std::uint8_t> fold(gathered.rows.size());
  for (const FitRow& row : gathered.rows) fold[row.index] = row.fold;
  std::size_t pairs = 0;
  for (const RowPart& part : gathered.parts) {
    if (part.share == 0) continue;
    EXPECT_EQ(fold[part.first], fold[part.first + 1]);
    ++pairs;
  }
  EXPECT_GT(pairs, 2900U);
}

TEST(MergedRows, are_those_of_long_logs_of_positions_of_one_sigma) {
  std::vector<Observation> log(kMostRowsUnmerged);
  EXPECT_FALSE(merges(log));
  log.emplace_back();
  EXPECT_TRUE(merges(log));
  log.back().sigma_m = 1e-4;
  EXPECT_FALSE(merges(log));
  log.back().sigma_m = 0;
  log.back().kind = calibration::ObservationKind::kRange;
  EXPECT_FALSE(merges(log));
}

// A row that stands for three is three rows at its place.
TEST(MergedRows, weigh_in_a_fit_as_what_they_stand_for) {
  test::Random random(11);
  const test::Cell cell = test::puma_cell(random);
  const auto once = test::position_rows(cell, 60, test::kRowSigma_m, random);
  auto thrice = once;
  thrice.insert(thrice.end(), once.begin(), once.end());
  thrice.insert(thrice.end(), once.begin(), once.end());
  auto together = once;
  for (FitRow& row : together) row.merged.count = 3;
  test::EngineCase apart(test::puma(), cell.X_SB, {cell.p_tool[0]}, thrice);
  test::EngineCase one(test::puma(), cell.X_SB, {cell.p_tool[0]}, together);
  const auto of_apart = apart.engine().run(test::kGeometryAlone);
  const auto of_one = one.engine().run(test::kGeometryAlone);
  ASSERT_TRUE(of_apart && of_one);
  EXPECT_EQ(of_one->rows, of_apart->rows);
  EXPECT_NEAR(of_one->degrees_of_model, of_apart->degrees_of_model, 1e-6);
  EXPECT_NEAR(one.engine().scales().sigma_squared, apart.engine().scales().sigma_squared, 1e-18);
  for (std::size_t j = 0; j < 6; ++j) {
    for (std::size_t c = 0; c < 5; ++c) {
      EXPECT_NEAR(one.model->joints[j].deviation[c], apart.model->joints[j].deviation[c], 1e-9);
    }
  }
}

}  // namespace
}  // namespace armsig::tool
