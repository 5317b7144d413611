// SPDX-License-Identifier: MIT
// What holds for every sweep of a circle or line, in figures.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

using test::TrueMotion;
using Vector7 = Eigen::Matrix<double, 7, 1>;
using Matrix7 = Eigen::Matrix<double, 7, 7>;

// Fisher information of (centre, rotation vector, radius) from the points' covariances, written out
// from p = c + R (r cos t, r sin t, 0) alone.
Matrix7 fisher_information(const TrueMotion& motion, const std::vector<double>& readings,
                           const std::vector<Matrix3>& covariances) {
  Matrix7 information = Matrix7::Zero();
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const Vector3 arm = motion.at(readings[i]) - motion.point_S;
    Eigen::Matrix<double, 3, 7> J;
    J << Matrix3::Identity(), -cross_matrix(arm), arm / motion.radius_m;
    information += J.transpose() * covariances[i].inverse() * J;
  }
  return information;
}

struct Trial {
  TrueMotion motion;
  std::vector<double> readings;
  std::vector<Matrix3> covariances;
};

Trial isotropic_trial(JointType type, double range, std::size_t count, test::Random& random) {
  Trial trial{test::random_motion(type, random), {}, {}};
  for (std::size_t i = 0; i < count; ++i) {
    trial.readings.push_back(test::even_reading(trial.motion, range, i, count));
    trial.covariances.push_back(test::isotropic(test::kSweepSigma_m));
  }
  return trial;
}

// Noise as a range sensor makes it: along the line of sight less than across, more across the
// farther away, different at every point.
void make_anisotropic(Trial& trial) {
  for (std::size_t i = 0; i < trial.readings.size(); ++i) {
    const Vector3 p_S = trial.motion.at(trial.readings[i]);
    const Vector3 sight = p_S.normalized();
    const Matrix3 along = sight * sight.transpose();
    const double across = 2 * p_S.norm() / 2.5;
    trial.covariances[i] = test::kSweepSigma_m * test::kSweepSigma_m *
                           (along + across * across * (Matrix3::Identity() - along));
  }
}

Judged<JointFeature> measure(const Trial& trial, Method method, test::Random& random) {
  SweepEstimator estimator({trial.motion.type, {}, method});
  for (std::size_t i = 0; i < trial.readings.size(); ++i) {
    const Matrix3 root = trial.covariances[i].llt().matrixL();
    const Vector3 p_S = trial.motion.at(trial.readings[i]) + root * random.normal_vector();
    EXPECT_TRUE(estimator.add(trial.readings[i], p_S, trial.covariances[i]));
  }
  return estimator.estimate();
}

struct Efficiency {
  double axis = 0;    // RMS error of the axis direction over its Cramer-Rao bound
  double centre = 0;  // RMS error of the centre over its bound
  double all = 0;     // mean of e^T I e / 7: mean variance over the bound, all parameters
};

Efficiency efficiency(double arc, std::size_t count, int trials, unsigned seed) {
  test::Random random(seed);
  double axis = 0;
  double axis_bound = 0;
  double centre = 0;
  double centre_bound = 0;
  double all = 0;
  for (int k = 0; k < trials; ++k) {
    const Trial trial = isotropic_trial(JointType::kRevolute, arc, count, random);
    const auto feature = measure(trial, Method::kEncoder, random);
    EXPECT_TRUE(feature);
    if (!feature) return {};
    const Vector7 e = test::feature_error(*feature, trial.motion);
    const Matrix7 information = fisher_information(trial.motion, trial.readings, trial.covariances);
    const Matrix7 bound = information.inverse();
    const Vector3 n = trial.motion.R_SC.col(2);
    const Matrix3 across = Matrix3::Identity() - n * n.transpose();
    // Each trial counts alike, whatever its radius.
    const double axis_variance = (across * bound.block<3, 3>(3, 3) * across).trace();
    const double centre_variance = bound.topLeftCorner<3, 3>().trace();
    axis += (across * e.segment<3>(3)).squaredNorm() / axis_variance;
    axis_bound += 1;
    centre += e.head<3>().squaredNorm() / centre_variance;
    centre_bound += 1;
    all += e.dot(information * e) / 7;
  }
  return {std::sqrt(axis / axis_bound), std::sqrt(centre / centre_bound), all / trials};
}

// The figures asked for are 5 %; the statistics of the trials themselves add 3 standard deviations.
// The axis of an arc has one direction much worse than the other: 1 degree of freedom a trial.
TEST(EncoderFeature, is_within_five_percent_of_its_cramer_rao_bound) {
  for (const double arc : {45.0, 90.0, 180.0, 300.0}) {
    for (const std::size_t count : {std::size_t{10}, std::size_t{36}, std::size_t{120}}) {
      const int trials = count < 100 ? 1000 : 300;
      const Efficiency e = efficiency(radians(arc), count, trials, 21);
      const double slack = 3 / std::sqrt(2.0 * trials);
      EXPECT_LT(e.axis, 1.05 + slack) << arc << " degrees, " << count << " points";
      EXPECT_LT(e.centre, 1.05 + slack) << arc << " degrees, " << count << " points";
      EXPECT_LT(e.all, 1.10 + 3 * std::sqrt(2.0 / (7 * trials))) << arc << ", " << count;
      EXPECT_GT(e.all, 0.9);
    }
  }
}

TEST(EncoderFeature, is_within_five_percent_of_its_cramer_rao_bound_for_thousands_of_points) {
  for (const double arc : {45.0, 300.0}) {
    const int trials = 150;
    const Efficiency e = efficiency(radians(arc), 3600, trials, 22);
    const double slack = 3 / std::sqrt(2.0 * trials);
    EXPECT_LT(e.axis, 1.05 + slack) << arc;
    EXPECT_LT(e.centre, 1.05 + slack) << arc;
    EXPECT_LT(e.all, 1.10 + 3 * std::sqrt(2.0 / (7 * trials))) << arc;
  }
}

// Mean of e^T C^-1 e over 1,000 trials; its 95 % bounds are the degrees of freedom +- 1.96 sqrt(2
// freedom / 1000).
double mean_square_error(JointType type, double range, std::size_t count, bool anisotropic,
                         Method method, unsigned seed) {
  test::Random random(seed);
  double sum = 0;
  for (int k = 0; k < 1000; ++k) {
    Trial trial = isotropic_trial(type, range, count, random);
    if (anisotropic) make_anisotropic(trial);
    const auto feature = measure(trial, method, random);
    EXPECT_TRUE(feature);
    if (!feature) return 0;
    const Vector7 e = test::feature_error(*feature, trial.motion);
    if (type == JointType::kRevolute) {
      sum += e.dot(feature->covariance.ldlt().solve(e));
      continue;
    }
    // Of a line: the point, and the direction in its two components.
    const Vector3 x = feature->radial_S;
    Eigen::Matrix<double, 5, 7> reduce = Eigen::Matrix<double, 5, 7>::Zero();
    reduce.block<3, 3>(0, 0).setIdentity();
    reduce.block<1, 3>(3, 3) = x.transpose();
    reduce.block<1, 3>(4, 3) = feature->axis_S.cross(x).transpose();
    const Eigen::Matrix<double, 5, 1> r = reduce * e;
    const Eigen::Matrix<double, 5, 5> C = reduce * feature->covariance * reduce.transpose();
    sum += r.dot(C.ldlt().solve(r));
  }
  return sum / 1000;
}

constexpr double kBound7 = 0.232;  // 1.96 sqrt(2 * 7 / 1000)
constexpr double kBound5 = 0.196;

TEST(StatedCovariance, of_the_encoder_referenced_circle_is_true) {
  for (const double arc : {60.0, 120.0, 240.0})
    EXPECT_NEAR(
        mean_square_error(JointType::kRevolute, radians(arc), 36, false, Method::kEncoder, 31), 7,
        kBound7)
        << arc;
}

TEST(StatedCovariance, is_true_where_the_noise_differs_along_the_sweep) {
  EXPECT_NEAR(mean_square_error(JointType::kRevolute, 2.5, 36, true, Method::kEncoder, 32), 7,
              kBound7);
}

TEST(StatedCovariance, of_the_papers_circle_is_true) {
  EXPECT_NEAR(mean_square_error(JointType::kRevolute, 2.5, 36, false, Method::kPaper, 33), 7,
              kBound7);
}

TEST(StatedCovariance, of_a_line_is_true_by_both_methods) {
  for (const Method method : {Method::kEncoder, Method::kPaper}) {
    EXPECT_NEAR(mean_square_error(JointType::kPrismatic, 0.4, 20, false, method, 34), 5, kBound5);
    EXPECT_NEAR(mean_square_error(JointType::kPrismatic, 0.4, 20, true, method, 35), 5, kBound5);
  }
}

// The reading tells the encoder-referenced circle what the paper's must find in the points.
TEST(EncoderFeature, beats_the_papers_fit_most_on_short_arcs) {
  double previous = 10;
  for (const double arc : {60.0, 300.0}) {
    test::Random random(41);
    double paper = 0;
    double encoder = 0;
    for (int k = 0; k < 300; ++k) {
      const Trial trial = isotropic_trial(JointType::kRevolute, radians(arc), 30, random);
      test::Random same = random;
      const auto by_paper = measure(trial, Method::kPaper, same);
      const auto by_encoder = measure(trial, Method::kEncoder, random);
      ASSERT_TRUE(by_paper && by_encoder);
      paper += (by_paper->point_S - trial.motion.point_S).squaredNorm();
      encoder += (by_encoder->point_S - trial.motion.point_S).squaredNorm();
    }
    const double gain = std::sqrt(paper / encoder);
    EXPECT_GT(gain, 1) << arc;
    EXPECT_LT(gain, previous) << arc;
    previous = gain;
  }
}

// Exact data, sensor 3 m away, readings near 1,000 rad, either sense.
TEST(ExactData, gives_the_exact_feature_by_both_methods) {
  test::Random random(51);
  for (int k = 0; k < 300; ++k) {
    TrueMotion motion =
        test::random_motion(k % 3 == 0 ? JointType::kPrismatic : JointType::kRevolute, random, 0.2);
    motion.point_S = 3 * random.direction();
    motion.first_reading = 1000 * random.normal();
    const bool revolute = motion.type == JointType::kRevolute;
    const double range = (k % 2 == 0 ? 1 : -1) * random.uniform(revolute ? kPi / 6 : 0.2, 1.5);
    const auto count = static_cast<std::size_t>(random.uniform(5, 200));
    for (const Method method : {Method::kPaper, Method::kEncoder}) {
      SweepEstimator estimator({motion.type, {}, method});
      for (std::size_t i = 0; i < count; ++i) {
        const double reading = test::even_reading(motion, range, i, count);
        ASSERT_TRUE(estimator.add(reading, motion.at(reading), Matrix3::Zero()));
      }
      const auto feature = estimator.estimate();
      ASSERT_TRUE(feature) << k;
      EXPECT_EQ(feature->quality.rejected, 0U);
      EXPECT_LT(test::feature_error(*feature, motion).cwiseAbs().maxCoeff(), 1e-12) << k;
    }
  }
}

}  // namespace
}  // namespace armsig::features
