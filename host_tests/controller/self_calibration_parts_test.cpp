// SPDX-License-Identifier: MIT
// The parts of the self-calibration: where it goes, and how it finds play.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/calibration/approach_direction.hpp"
#include "firmware/controller/pose_visit.hpp"
#include "firmware/self_calibration/findings.hpp"
#include "firmware/self_calibration/pose_choice.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

// What a fit leaves to be said where its prior is so narrow that it found nothing.
TEST(HalfPlays, finds_the_play_of_every_joint_among_noise) {
  constexpr double kSigma_m = 0.1e-3;
  constexpr double kHalf = 5e-5;
  simulated::Random random(1);
  calibration::PlayBlock found;
  for (std::size_t n = 0; n < 400; ++n) {
    const Sides sides = dealt_sides(n);
    Eigen::Matrix<double, 3, kMaxJoints> columns = Eigen::Matrix<double, 3, kMaxJoints>::Zero();
    Vector3 residual = kSigma_m * random.normal_vector();
    for (Eigen::Index i = 0; i < 2; ++i) {
      const Vector3 motion(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      columns.col(i) = -side_of(sides, static_cast<std::size_t>(i)) * motion;
      residual += static_cast<double>(i) * kHalf * columns.col(i);
    }
    found.gradient += columns.transpose() * residual / (kSigma_m * kSigma_m);
    found.told += columns.transpose() * columns / (kSigma_m * kSigma_m);
  }
  const auto halves = half_plays(found, 3);
  ASSERT_EQ(halves.size(), 3U);
  EXPECT_NEAR(halves[0].value, 0, 3 * halves[0].sigma);
  EXPECT_EQ(halves[0].squared(), 0);
  EXPECT_NEAR(halves[1].value, kHalf, 3 * halves[1].sigma);
  EXPECT_NEAR(halves[1].squared(), kHalf * kHalf, 0.3 * kHalf * kHalf);
  // 400 poses, each of a lever whose mean square is one.
  EXPECT_NEAR(halves[1].sigma, kSigma_m / 20, 0.1 * kSigma_m / 20);
  EXPECT_FALSE(std::isfinite(halves[2].sigma)) << "nothing moves by it";
}

TEST(HalfPlays, are_what_the_fit_found_and_what_its_prior_held_back) {
  calibration::PlayBlock found;
  found.half(0) = 3e-5;
  found.told(0, 0) = 1e10;
  found.gradient(0) = 1e10 * 2e-5;
  EXPECT_NEAR(half_plays(found, 1)[0].value, 5e-5, 1e-12);
  EXPECT_NEAR(half_plays(found, 1)[0].sigma, 1e-5, 1e-12);
}

TEST(ApproachDirection, knows_the_side_of_a_joint_once_it_has_moved_and_while_it_stands) {
  const JointTypes types{JointType::kRevolute, JointType::kPrismatic};
  calibration::ApproachDirection coming;
  coming.go_to(types, {0.0, 0.1});
  EXPECT_EQ(coming.sided(), 0U) << "nobody knows how it came there";
  coming.go_to(types, {0.1, 0.1});
  EXPECT_EQ(coming.sided(), 1U);
  EXPECT_EQ(coming.sides() & 1U, 1U);
  coming.go_to(types, {0.1 + 1e-5, 0.09});
  EXPECT_EQ(coming.sided(), 3U);
  EXPECT_EQ(coming.sides(), 1U) << "the one stands, the other came down";
  coming.go_to(types, {0.0, 0.09});
  EXPECT_EQ(coming.sides(), 0U);
  coming.go_to(types, {0.001, 0.09});
  EXPECT_EQ(coming.sided(), 2U) << "its play may not have been taken up";
  coming.forget();
  coming.go_to(types, {0.5, 0.5});
  EXPECT_EQ(coming.sided(), 0U);
}

// What a line through all points but one says of that one, beside the short way by the residual.
TEST(HeldOutJudge, says_of_a_fitted_row_what_a_fit_without_it_says) {
  constexpr std::size_t kRows = 8;
  constexpr double kVariance = 1e-8;
  simulated::Random random(3);
  std::array<Eigen::Matrix<double, 3, 4>, kRows> A;
  std::array<Vector3, kRows> y;
  for (std::size_t i = 0; i < kRows; ++i) {
    A[i] << Matrix3::Identity(), random.normal_vector();
    y[i] = 3e-4 * random.normal_vector();  // three times the noise stated
  }
  const auto fit_without = [&](std::size_t left_out) {
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Vector4d pull = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < kRows; ++i) {
      if (i == left_out) continue;
      normal += A[i].transpose() * A[i];
      pull += A[i].transpose() * y[i];
    }
    const Eigen::Matrix4d inverse = normal.inverse();
    return std::pair<Eigen::Vector4d, Eigen::Matrix4d>(inverse * pull, kVariance * inverse);
  };
  const auto [all, C] = fit_without(kRows);
  HeldOutJudge judge;
  double squares = 0;
  double stated = 0;
  for (std::size_t i = 0; i < kRows; ++i) {
    judge.add_fitted(y[i] - A[i] * all, {.row = kVariance * Matrix3::Identity(),
                                         .model = A[i] * C * A[i].transpose()});
    const auto [x, C_without] = fit_without(i);
    const Vector3 error = y[i] - A[i] * x;
    const Matrix3 model = A[i] * C_without * A[i].transpose();
    squares += error.squaredNorm() - 3 * kVariance;
    stated += model.trace();
  }
  ASSERT_GT(squares / stated, 1) << "the factor tells something";
  EXPECT_NEAR(judge.score().factor, std::sqrt(squares / stated), 1e-5);
}

// One row too few to be without it.
TEST(HeldOutJudge, takes_nothing_from_a_row_that_alone_determines_something) {
  HeldOutJudge judge;
  judge.add_fitted(Vector3(1e-3, 0, 0),
                   {.row = 1e-8 * Matrix3::Identity(), .model = 1e-8 * Matrix3::Identity()});
  EXPECT_EQ(judge.score().factor, 1);
}

// A decimetre along what the row determines to 95 parts in 100, nothing elsewhere.
TEST(HeldOutJudge, takes_nothing_from_a_direction_that_a_row_all_but_determines) {
  HeldOutJudge judge;
  const Matrix3 model = 1e-8 * Vector3(0.95, 0.1, 0.1).asDiagonal();
  judge.add_fitted(Vector3(0.1, 0, 0), {.row = 1e-8 * Matrix3::Identity(), .model = model});
  EXPECT_EQ(judge.score().factor, 1);
  judge.add_fitted(Vector3(0, 0.1, 0), {.row = 1e-8 * Matrix3::Identity(), .model = model});
  EXPECT_GT(judge.score().factor, 100);
}

TEST(Findings, tell_how_many_times_the_measurements_it_takes) {
  const Findings findings{
      .held_out = {}, .model_m = 0.16e-3, .play_m = 0.06e-3, .sensor_m = 0, .play = {}};
  EXPECT_NEAR(findings.predicted_m(), 0.170880e-3, 1e-9);
  EXPECT_NEAR(findings.times_more(0.1e-3), 4, 1e-9);
  EXPECT_FALSE(std::isfinite(findings.times_more(0.06e-3))) << "play alone is as much";
  EXPECT_FALSE(findings.is_believed()) << "no pose was held out";
}

TEST(MeasurementLog, goes_on_in_what_is_lent_to_it) {
  std::array<LogEntry, 3> lent;
  MeasurementLog log;
  log.extend(lent);
  EXPECT_EQ(log.capacity(), kMostLogged + 3);
  for (std::size_t k = 0; k < kMostLogged + 3; ++k) {
    ASSERT_FALSE(log.full());
    log.push_back({0, k % 100, {0.5}, Vector3::Zero(), 1e-4});
  }
  EXPECT_TRUE(log.full());
  EXPECT_EQ(log[kMostLogged - 1].pings(), (kMostLogged - 1) % 100);
  EXPECT_EQ(log[kMostLogged + 2].pings(), (kMostLogged + 2) % 100);
  EXPECT_EQ(lent[0].pings(), kMostLogged % 100);
  log.clear();
  EXPECT_EQ(log.size(), 0U);
}

// Three joints: one that slides, one whose readings were measured in part.
Prediction predicted() {
  Prediction prediction;
  prediction.poses = 4;
  prediction.maps_m2 = {4e-8, 16e-8, 0};
  prediction.uncovered_m2 = {0, 4e-8, 36e-8};
  prediction.plays_m2 = {1e-8, 0, 0};
  prediction.levers_m2 = {4.0, 1.0, 0.04};
  prediction.model_m2 = 96e-8;
  return prediction;
}

TEST(Budget, has_each_part_of_what_is_predicted_and_the_joint_that_has_most_of_it) {
  const JointTypes types{JointType::kPrismatic, JointType::kRevolute, JointType::kRevolute};
  const Budget budget = budget_of(predicted(), types, 7e-4);
  EXPECT_NEAR(budget.geometry_m, 3e-4, 1e-12);
  EXPECT_NEAR(budget.maps.length_m, std::sqrt(5e-8), 1e-12);
  EXPECT_EQ(budget.maps.joint, 1U);
  EXPECT_NEAR(budget.maps.of_joint_m, 2e-4, 1e-12);
  EXPECT_NEAR(budget.uncovered.length_m, std::sqrt(10e-8), 1e-12);
  EXPECT_EQ(budget.uncovered.joint, 2U);
  EXPECT_NEAR(budget.uncovered.of_joint_m, 3e-4, 1e-12);
  EXPECT_EQ(budget.play.joint, 0U);
  EXPECT_NEAR(budget.play.length_m, 5e-5, 1e-12);
  EXPECT_NEAR(budget.unexplained_m, 5e-4, 1e-12);
  EXPECT_EQ(budget.shortest, 2U);
  EXPECT_NEAR(budget.lever_m, 0.1, 1e-12);
}

TEST(Budget, tells_no_slide_as_the_joint_that_moves_the_target_least) {
  Prediction prediction = predicted();
  prediction.levers_m2 = {0.0001, 1.0, 4.0};
  const JointTypes types{JointType::kPrismatic, JointType::kRevolute, JointType::kRevolute};
  EXPECT_EQ(budget_of(prediction, types, 0).shortest, 1U);
  EXPECT_EQ(budget_of(prediction, types, 0).unexplained_m, 0);
}

TEST(Budget, counts_a_reading_as_covered_between_the_least_and_the_largest) {
  Covered covered;
  EXPECT_FALSE(covered.has(0, 0.0));
  covered.add({-0.5, 1.0});
  covered.add({0.25, 2.0});
  EXPECT_TRUE(covered.has(0, 0.2));
  EXPECT_FALSE(covered.has(0, 0.3));
  EXPECT_FALSE(covered.has(0, -0.6));
  EXPECT_TRUE(covered.has(1, 1.5));
}

TEST(PoseChoice, deals_both_sides_of_every_joint_alike) {
  std::array<int, 6> grows{};
  int both = 0;
  for (std::size_t n = 0; n < 400; ++n) {
    const Sides sides = dealt_sides(n);
    for (std::size_t i = 0; i < grows.size(); ++i) grows[i] += side_of(sides, i) > 0;
    both += side_of(sides, 0) > 0 && side_of(sides, 1) > 0;
  }
  for (const int count : grows) EXPECT_NEAR(count, 200, 30);
  EXPECT_NEAR(both, 100, 30);
}

TEST(PoseChoice, comes_from_the_side_that_is_told_within_the_limits) {
  const Configuration configuration = test::puma_controller();
  for (std::size_t n = 0; n < 200; ++n) {
    JointVector pose = offered_pose(configuration, n);
    const auto [lower, upper] = configuration.drawing.limits[0];
    if (n % 3 == 1) pose[0] = lower;
    if (n % 3 == 2) pose[0] = upper;
    Sides sides = dealt_sides(n);
    const JointVector from = approach_to(configuration, pose, sides);
    for (std::size_t i = 0; i < pose.size(); ++i) {
      EXPECT_NEAR(pose[i] - from[i], side_of(sides, i) * radians(1.0), 1e-12);
      EXPECT_GE(from[i], configuration.drawing.limits[i].lower);
      EXPECT_LE(from[i], configuration.drawing.limits[i].upper);
    }
  }
}

TEST(PoseChoice, never_offers_a_pose_that_judges) {
  const Configuration configuration = test::puma_controller();
  // Also of those that are looked for where a workspace box excludes the first ones.
  std::vector<JointVector> judging;
  for (std::size_t k = 0; k < 1000; ++k) {
    judging.push_back(held_out_pose(configuration, k));
    const auto [lower, upper] = configuration.drawing.limits[0];
    EXPECT_TRUE(judging[k][0] > lower && judging[k][0] < upper) << k;
    for (std::size_t before = 0; before < k; ++before) {
      EXPECT_NE(judging[before][0], judging[k][0]) << before << " and " << k;
    }
  }
  for (std::size_t k = 0; k < kMostHeldOut; ++k) {
    EXPECT_EQ(judging[k][0], spread_pose(configuration, k)[0]) << k;
  }
  for (std::size_t n = 0; n < 500; ++n) {
    const JointVector offered = offered_pose(configuration, n);
    for (const JointVector& pose : judging) EXPECT_NE(offered[0], pose[0]) << n;
  }
}

}  // namespace
}  // namespace armsig::controller
