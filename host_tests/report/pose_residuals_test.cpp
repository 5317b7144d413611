// SPDX-License-Identifier: MIT
// What the report shows of free poses, on a real arm where its data are there.
#include "firmware/host_tool/report/pose_residuals.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "firmware/host_tool/report/uncertain_signature.hpp"
#include "host_tests/support/demo_features.hpp"

namespace armsig::tool {
namespace {

constexpr double kSigma_m = 1e-4;
constexpr int kPoses = 3000;

SignatureRecord demo_record(const Signature& signature) {
  SignatureRecord record;
  record.signature = signature;
  record.method = "refined";
  record.nominal = puma560();
  record.sigma_m = kSigma_m;
  return record;
}

// Free poses of the very arm of the record, with the noise of its sensor.
MeasuredSweeps drawn_poses(const SignatureRecord& record) {
  MeasuredSweeps measured;
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0, kSigma_m);
  const calibration::PoeChain chain(record.signature, record.readings());
  const Target& target = record.signature.targets.back();
  std::uniform_real_distribution<double> share(0.1, 0.9);
  for (std::size_t k = 0; k < kPoses; ++k) {
    MeasuredPose row;
    row.line = k + 2;
    row.target = target.number;
    for (const JointLimits& limits : record.nominal.limits) {
      row.q.push_back(limits.lower + share(random) * (limits.upper - limits.lower));
    }
    row.p_S = chain.point(chain.motion(row.q), target) +
              Vector3(noise(random), noise(random), noise(random));
    measured.rows_located.push_back(row);
  }
  return measured;
}

class DemoPoses : public testing::Test {
 protected:
  void SetUp() override {
    const auto found = test::found_by_features(measured_demo_robot(1, 1));
    ASSERT_TRUE(found);
    record = demo_record(*found);
    measured = drawn_poses(record);
  }
  SignatureRecord record;
  MeasuredSweeps measured;
};

TEST_F(DemoPoses, have_residuals_of_the_size_of_the_noise) {
  const auto poses = pose_residuals(record, measured, nullptr);
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->poses.size(), static_cast<std::size_t>(kPoses));
  EXPECT_NEAR(poses->signature.rms_m, std::sqrt(3.0) * kSigma_m, 0.03 * kSigma_m);
  EXPECT_EQ(poses->outliers, 0U);
  EXPECT_EQ(poses->stated_rms_m, 0);
  EXPECT_TRUE(poses->histogram.expected.empty());
  for (const PoseResidual& pose : poses->poses) {
    for (const auto& along : pose.along_m) {
      if (along) {
        ASSERT_LE(std::abs(*along), pose.length_m() * (1 + 1e-12));
      }
    }
  }
}

TEST_F(DemoPoses, have_the_histogram_that_their_noise_leads_to) {
  auto poses = pose_residuals(record, measured, nullptr);
  ASSERT_TRUE(poses);
  const double bin_m = poses->histogram.bin_m;
  double chi_square = 0;
  double counted = 0;
  int judged = 0;
  for (std::size_t k = 0; k < poses->histogram.counts.size(); ++k) {
    counted += poses->histogram.counts[k];
    const double from = length_probability(static_cast<double>(k) * bin_m / kSigma_m);
    const double to = length_probability(static_cast<double>(k + 1) * bin_m / kSigma_m);
    const double expected = kPoses * (to - from);
    if (expected < 5) continue;
    chi_square += std::pow(poses->histogram.counts[k] - expected, 2) / expected;
    ++judged;
  }
  EXPECT_EQ(counted, kPoses);
  EXPECT_GT(judged, 15);
  EXPECT_LT(chi_square, judged + 5 * std::sqrt(2.0 * judged));
}

TEST_F(DemoPoses, name_the_outlier_and_state_more_than_the_noise) {
  measured.rows_located[41].p_S += Vector3(0.002, -0.001, 0);
  const auto estimate = estimate_behind(record);
  ASSERT_TRUE(estimate);
  const auto poses = pose_residuals(record, measured, estimate.get());
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->outliers, 1U);
  EXPECT_TRUE(poses->poses[41].outlier);
  EXPECT_EQ(poses->poses[41].line, 43U);
  EXPECT_GT(poses->stated_rms_m, std::sqrt(3.0) * kSigma_m);
  double expected = 0;
  for (const double share : poses->histogram.expected) expected += share;
  EXPECT_NEAR(expected, kPoses, 1e-6);
}

// A joint that turns further than it reads shows along its own motion, and nowhere else.
TEST_F(DemoPoses, show_the_error_of_a_reading_along_the_motion_of_its_joint) {
  constexpr double kError_rad = 1e-3;
  for (MeasuredPose& row : measured.rows_located) row.q[0] -= kError_rad;
  const auto poses = pose_residuals(record, measured, nullptr);
  ASSERT_TRUE(poses);
  for (const PoseResidual& pose : poses->poses) {
    ASSERT_TRUE(pose.along_m[0]);
    ASSERT_NEAR(*pose.along_m[0], pose.length_m(), 8 * kSigma_m);
  }
}

TEST_F(DemoPoses, are_none_in_sweeps) {
  for (MeasuredPose& row : measured.rows_located) row.sweep = 3;
  EXPECT_FALSE(pose_residuals(record, measured, nullptr));
}

TEST(LengthProbability, is_that_of_tables) {
  EXPECT_NEAR(length_probability(std::sqrt(2.3659739)), 0.5, 1e-7);
  EXPECT_NEAR(length_probability(2.795483), 0.95, 1e-6);
  EXPECT_EQ(length_probability(0), 0);
}

}  // namespace
}  // namespace armsig::tool
