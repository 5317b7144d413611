// SPDX-License-Identifier: MIT
// What the features of sweeps state of the tool is its accuracy where positions come from ranges: a
// position from three receivers errs along one direction by far the most, and not alike along the
// sweep. Over so many arms that chance is 3 %: every_kind_of_row_test.cpp judges the whole command,
// by few.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/features/sweep_estimator.hpp"
#include "core/identification.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/analysis/uncertainty/feature_information.hpp"
#include "firmware/analysis/uncertainty/tool_covariance.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig {
namespace {

using features::JointFeature;
using test::Cell;
using test::Random;

constexpr int kArms = 200;
constexpr int kPointsASweep = 60;
constexpr int kJudged = 100;
constexpr double kRangeSigma_m = 0.2e-3;
// Of the sigma of a ping, for the median of 1, 4 and 9: by numerical integration.
constexpr std::array<std::pair<int, double>, 3> kMedianOf{{{1, 1.0}, {4, 0.5461}, {9, 0.4076}}};

measurement::ReceiverArray over_the_arm(std::size_t count, double range_sigma_m) {
  measurement::ReceiverArray array;
  for (std::size_t k = 0; k < count; ++k) {
    const double turn = 2 * kPi * static_cast<double>(k) / static_cast<double>(count);
    const double radius = k % 2 == 0 ? 1.4 : 1.0;
    array.p_S.push_back(Vector3(radius * std::cos(turn), radius * std::sin(turn),
                                0.4 * static_cast<double>(k % 3)));
  }
  array.range_sigma_m = range_sigma_m;
  array.facing_S = -Vector3::UnitZ();
  return array;
}

double median_of_pings(double true_m, int pings, Random& random) {
  std::vector<double> heard_m;
  for (int k = 0; k < pings; ++k) heard_m.push_back(true_m + random.normal(kRangeSigma_m));
  std::ranges::sort(heard_m);
  const std::size_t count = heard_m.size();
  return (heard_m[(count - 1) / 2] + heard_m[count / 2]) / 2;
}

JointFeature swept(const Cell& cell, const JointVector& held, std::size_t joint, int pings,
                   const measurement::ReceiverArray& array, Random& random) {
  features::SweepEstimator estimator({.type = JointType::kRevolute});
  const JointLimits& limit = cell.arm.limits[joint];
  for (int k = 0; k < kPointsASweep; ++k) {
    JointVector q = held;
    q[joint] = limit.lower + (limit.upper - limit.lower) * k / (kPointsASweep - 1);
    measurement::Ranges ranges;
    for (const Vector3& receiver_S : array.p_S) {
      const double true_m = (cell.point(q, 0) - receiver_S).norm();
      ranges.push_back({.metres = median_of_pings(true_m, pings, random), .valid = true});
    }
    const auto position = measurement::trilaterate(array, ranges);
    if (!position) continue;
    EXPECT_TRUE(estimator.add(q[joint], position->p_S, position->covariance_m2));
  }
  const auto feature = estimator.estimate();
  EXPECT_TRUE(feature) << "joint " << joint + 1;
  return *feature;
}

struct Errors {
  double squared_m2 = 0;  // of the tool, mean over poses
  double stated_m2 = 0;
};

Errors errors_of(std::size_t receivers, int pings, double of_median, std::uint64_t seed) {
  Random random(seed);
  const Cell cell{test::made_to(test::puma(), {}, random),
                  Pose{rotation_z(random.uniform(-3, 3)) * rotation_x(0.03),
                       Vector3(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), -1.2)},
                  {Vector3(0.25, 0.05, 0.12)}};
  const auto array = over_the_arm(receivers, of_median * kRangeSigma_m);
  JointVector held;
  for (const JointLimits& limit : cell.arm.limits) held.push_back((limit.lower + limit.upper) / 2);
  FixedVector<JointFeature, kMaxJoints> found;
  for (std::size_t j = 0; j < held.size(); ++j) {
    found.push_back(swept(cell, held, j, pings, array, random));
  }
  auto signature = *identify(found, held, test::puma());
  signature.targets.push_back({.number = 1,
                               .link = held.size(),
                               .p_S = found.back().target_at(held.back()),
                               .covariance_m2 = found.back().target_covariance_at(held.back())});
  const auto estimate = std::make_unique<calibration::Refined>();
  EXPECT_TRUE(uncertainty::from_features(signature, *estimate));
  Errors errors;
  errors.stated_m2 = std::pow(uncertainty::predicted_rms(*estimate, cell.arm.limits, 0), 2);
  for (int k = 0; k < kJudged; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const Vector3 missed = uncertainty::tool_position(*estimate, q, 0) - cell.point(q, 0);
    errors.squared_m2 += missed.squaredNorm() / kJudged;
  }
  return errors;
}

// Root mean square over the arms of true over stated.
double true_over_stated(std::size_t receivers, int pings, double of_median) {
  double squares = 0;
  for (int k = 1; k <= kArms; ++k) {
    const Errors errors =
        errors_of(receivers, pings, of_median, 1000 + static_cast<std::uint64_t>(k));
    squares += errors.squared_m2 / errors.stated_m2 / kArms;
  }
  return std::sqrt(squares);
}

TEST(StatedByFeatures, of_ranges_is_what_the_tool_misses_by) {
  for (const std::size_t receivers : {3U, 4U, 8U}) {
    for (const auto& [pings, of_median] : kMedianOf) {
      EXPECT_NEAR(true_over_stated(receivers, pings, of_median), 1, 0.12)
          << receivers << " receivers, " << pings << " pings";
    }
  }
}

}  // namespace
}  // namespace armsig
