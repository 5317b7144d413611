// SPDX-License-Identifier: MIT
// A stated accuracy is the accuracy: over simulated arms that are not as the model says.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"

namespace armsig::calibration {
namespace {

using test::Calibration;
using test::Cell;
using test::Random;

constexpr int kArms = 24;
constexpr int kPoses = 120;
constexpr int kJudged = 100;

struct Tally {
  double observed = 0;
  double stated = 0;
  double inside = 0;
  double judged = 0;

  [[nodiscard]] double ratio() const { return std::sqrt(observed / stated); }
};

// Noise with the tails of real instruments: one row in ten is three times as noisy.
Vector3 noise(double sigma, Random& random) {
  return random.normal_vector(random.uniform(0, 1) < 0.1 ? 3 * sigma : sigma);
}

Tally judge(const ModelParts& parts, std::uint64_t seed) {
  Tally sum;
  for (int k = 0; k < kArms; ++k) {
    Random random(seed + static_cast<std::uint64_t>(k));
    const Cell cell = test::puma_cell(random);
    const double sigma = std::pow(10, random.uniform(-5, -3.7));
    const test::Misbehaviour m{.wave_rad = radians(random.uniform(0, 0.02)),
                               .sag_rad_m = random.uniform(0, 1e-3),
                               .phase = random.uniform(0, 6)};
    const auto measure = [&](int poses) {
      test::Log log;
      for (int p = 0; p < poses; ++p) {
        Observation row;
        row.readings = random.configuration(cell.arm);
        row.p_S = test::misbehaving_point(cell, row.readings, m) + noise(sigma, random);
        log.push_back(row);
      }
      return log;
    };
    Calibration fit(test::puma(), measure(kPoses), parts);
    EXPECT_TRUE(fit.fit());
    const test::Log others = measure(kJudged);
    std::vector<Engine::Stated> stated(others.size());
    std::vector<Vector3> errors;
    for (std::size_t p = 0; p < others.size(); ++p) {
      errors.emplace_back(others[p].p_S - fit.predict(others[p].readings, &stated[p]));
    }
    const auto score = fit.held_out();
    EXPECT_TRUE(score);
    if (!score) continue;
    Tally arm;
    for (std::size_t p = 0; p < others.size(); ++p) {
      const Matrix3 S = stated[p].row + stated[p].model;
      arm.observed += errors[p].squaredNorm();
      arm.stated += score->factor * score->factor * S.trace();
      arm.inside += errors[p].dot(S.inverse() * errors[p]) <= score->region_squares ? 1 : 0;
    }
    EXPECT_GT(arm.ratio(), 0.6) << k;
    EXPECT_LT(arm.ratio(), 1.6) << k;
    // Every arm counts the same, however noisy.
    sum.observed += arm.observed / arm.stated;
    sum.stated += 1;
    sum.inside += arm.inside;
    sum.judged += kJudged;
  }
  return sum;
}

TEST(StatedAccuracy, is_the_accuracy_of_the_geometry_alone) {
  const Tally tally = judge({.gravity = false, .maps = false}, 100);
  EXPECT_GT(tally.ratio(), 0.8);
  EXPECT_LT(tally.ratio(), 1.25);
  EXPECT_GT(tally.inside / tally.judged, 0.90);
  EXPECT_LT(tally.inside / tally.judged, 0.98);
}

TEST(StatedAccuracy, is_the_accuracy_of_the_whole_model) {
  const Tally tally = judge({}, 200);
  EXPECT_GT(tally.ratio(), 0.8);
  EXPECT_LT(tally.ratio(), 1.25);
  EXPECT_GT(tally.inside / tally.judged, 0.90);
  EXPECT_LT(tally.inside / tally.judged, 0.98);
}

}  // namespace
}  // namespace armsig::calibration
