// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "firmware/analysis/evaluation/fusion.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

using test::TrueMotion;

JointFeature feature_of(const TrueMotion& motion, double range, test::Random& random,
                        double sigma_m = test::kSweepSigma_m) {
  SweepEstimator estimator({motion.type, {}});
  for (std::size_t i = 0; i < 30; ++i) {
    const double reading = test::even_reading(motion, range, i, 30);
    const Vector3 p_S = motion.at(reading) + sigma_m * random.normal_vector();
    EXPECT_TRUE(estimator.add(reading, p_S, test::isotropic(sigma_m)));
  }
  const auto feature = estimator.estimate();
  EXPECT_TRUE(feature);
  return feature.value_or(JointFeature{});
}

// A second target that turns about the same axis, elsewhere along it.
TrueMotion companion(const TrueMotion& motion) {
  TrueMotion other = motion;
  other.point_S += 0.3 * motion.R_SC.col(2);
  other.R_SC = motion.R_SC * rotation_z(1.1);
  other.radius_m = 0.4;
  if (motion.type == JointType::kPrismatic) other.point_S += 0.2 * motion.R_SC.col(0);
  return other;
}

double axis_square(const JointFeature& feature, const TrueMotion& truth) {
  return feature.axis_S.cross(truth.R_SC.col(2)).squaredNorm();
}

TEST(Fuse, makes_the_axis_better_than_either_target_alone) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    test::Random random(11);
    double first = 0;
    double second = 0;
    double fused = 0;
    for (int trial = 0; trial < 300; ++trial) {
      const TrueMotion motion = test::random_motion(type, random);
      const TrueMotion other = companion(motion);
      const JointFeature a = feature_of(motion, 1.5, random);
      const JointFeature b = feature_of(other, 1.5, random);
      first += axis_square(a, motion);
      second += axis_square(b, motion);
      fused += axis_square(fuse(a, b), motion);
    }
    EXPECT_LT(fused, 0.8 * first);
    EXPECT_LT(fused, 0.8 * second);
  }
}

// 7 degrees of freedom; the mean of 300 has a standard deviation of 0.22.
TEST(Fuse, states_the_covariance_truly) {
  test::Random random(12);
  double sum = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
    const JointFeature a = feature_of(motion, 2, random);
    const JointFeature fused = fuse(a, feature_of(companion(motion), 2, random));
    const Eigen::Matrix<double, 7, 1> error = test::feature_error(fused, motion);
    const Eigen::Matrix<double, 7, 1> solved = fused.covariance.ldlt().solve(error);
    sum += error.dot(solved);
  }
  EXPECT_NEAR(sum / 300, 7, 0.7);
}

TEST(Fuse, keeps_the_first_target) {
  test::Random random(13);
  const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
  const JointFeature a = feature_of(motion, 2, random);
  const JointFeature fused = fuse(a, feature_of(companion(motion), 2, random));
  EXPECT_EQ(fused.reference_reading, a.reference_reading);
  EXPECT_LT((fused.target_at(motion.first_reading) - motion.at(motion.first_reading)).norm(), 1e-3);
  EXPECT_EQ(fused.quality.used, 60U);
  EXPECT_NEAR(fused.axis_S.norm(), 1, 1e-15);
  EXPECT_NEAR(fused.axis_S.dot(fused.radial_S), 0, 1e-15);
}

TEST(Fuse, tells_the_quality_of_both_sweeps_together) {
  test::Random random(13);
  const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
  JointFeature a = feature_of(motion, 2, random);
  JointFeature b = feature_of(companion(motion), 2, random);
  a.quality = {.used = 10,
               .rejected = 5,
               .lowest_reading = -1,
               .highest_reading = 2,
               .rms_normal_m = 1e-4,
               .rms_radial_m = 2e-4,
               .rms_tangential_m = 3e-4,
               .encoder_ratio = 1.01,
               .encoder_ratio_sigma = 0.03,
               .sigma_m = 4e-4};
  b.quality = {.used = 30,
               .rejected = 2,
               .lowest_reading = 0,
               .highest_reading = 3,
               .rms_normal_m = 5e-4,
               .rms_radial_m = 6e-4,
               .rms_tangential_m = 7e-4,
               .encoder_ratio = 1.02,
               .encoder_ratio_sigma = 0.04,
               .sigma_m = 8e-4,
               .sigma_is_estimated = true};
  for (const bool swapped : {false, true}) {
    const SweepQuality q = (swapped ? fuse(b, a) : fuse(a, b)).quality;
    EXPECT_EQ(q.used, 40U);
    EXPECT_EQ(q.rejected, 7U);
    EXPECT_EQ(q.lowest_reading, -1);
    EXPECT_EQ(q.highest_reading, 3);
    EXPECT_NEAR(q.rms_normal_m, std::sqrt((1.0 + 3 * 25) / 4) * 1e-4, 1e-15);
    EXPECT_NEAR(q.rms_radial_m, std::sqrt((4.0 + 3 * 36) / 4) * 1e-4, 1e-15);
    EXPECT_NEAR(q.rms_tangential_m, std::sqrt((9.0 + 3 * 49) / 4) * 1e-4, 1e-15);
    EXPECT_NEAR(q.sigma_m, std::sqrt((16.0 + 3 * 64) / 4) * 1e-4, 1e-15);
    EXPECT_TRUE(q.sigma_is_estimated);
    EXPECT_NEAR(q.encoder_ratio, (16 * 1.01 + 9 * 1.02) / 25, 1e-12);  // by 1 / sigma^2
    EXPECT_NEAR(q.encoder_ratio_sigma, 0.03 * 0.04 / 0.05, 1e-12);
  }
}

TEST(Fuse, of_exact_features_is_exact) {
  for (const JointType type : {JointType::kRevolute, JointType::kPrismatic}) {
    test::Random random(14);
    const TrueMotion motion = test::random_motion(type, random);
    const JointFeature a = feature_of(motion, 2, random, 0);
    const JointFeature fused = fuse(a, feature_of(companion(motion), 2, random, 0));
    EXPECT_LT(test::feature_error(fused, motion).norm(), 1e-13);
  }
}

TEST(Fuse, of_different_joint_types_traps) {
  JointFeature a;
  JointFeature b;
  b.type = JointType::kPrismatic;
  EXPECT_DEATH((void)fuse(a, b), "");
}

// Two signatures of which nobody knows how many points they rest on, and one that is exact.
TEST(Fuse, takes_no_share_of_what_says_nothing_of_its_weight) {
  test::Random random(13);
  const TrueMotion motion = test::random_motion(JointType::kRevolute, random);
  JointFeature a = feature_of(motion, 1.5, random);
  JointFeature b = feature_of(companion(motion), 1.5, random);
  b.quality.encoder_ratio = 1.5;
  b.quality.encoder_ratio_sigma = 0;
  EXPECT_EQ(fuse(a, b).quality.encoder_ratio, a.quality.encoder_ratio);
  EXPECT_EQ(fuse(b, a).quality.encoder_ratio, 1.5);
  a.quality.used = b.quality.used = 0;
  EXPECT_EQ(fuse(a, b).quality.rms_normal_m, 0);
}

}  // namespace
}  // namespace armsig::features
