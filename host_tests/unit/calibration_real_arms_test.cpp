// SPDX-License-Identifier: MIT
// The estimator of geometry, gravity and reading maps on real arms, measured by a laser tracker.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"
#include "host_tests/support/shared_arms.hpp"

namespace armsig::calibration {
namespace {

using test::Calibration;
using test::Log;

Log read_log(const std::string& file) {
  std::ifstream stream(std::filesystem::path(ARMSIG_SHARED_DATA) / file);
  std::string line;
  std::getline(stream, line);  // comment
  std::getline(stream, line);  // header
  Log log;
  while (std::getline(stream, line)) {
    std::istringstream cells(line);
    std::vector<double> values;
    for (std::string cell; std::getline(cells, cell, ',');) values.push_back(std::stod(cell));
    Observation row;
    for (std::size_t j = 0; j < 6; ++j) row.readings.push_back(radians(values[2 + j]));
    row.p_S = 1e-3 * Vector3(values[8], values[9], values[10]);
    log.push_back(row);
  }
  return log;
}

// Half of a real log fitted, the other half predicted; mean [m].
double score_other_half(const std::string& arm, const std::string& file, std::uint64_t seed,
                        double& stated_over_observed) {
  Log log = read_log(file);
  std::shuffle(log.begin(), log.end(), std::mt19937_64(seed));
  const auto half = log.begin() + static_cast<std::ptrdiff_t>(log.size() / 2);
  Calibration fit(test::shared_arm(arm), Log(log.begin(), half), ModelParts{});
  EXPECT_TRUE(fit.fit());
  double stated = 0;
  double observed = 0;
  double lengths = 0;
  for (auto row = half; row != log.end(); ++row) {
    Engine::Stated S;
    const Vector3 error = row->p_S - fit.predict(row->readings, &S);
    observed += error.squaredNorm();
    lengths += error.norm();
    stated += S.row.trace() + S.model.trace();
  }
  stated_over_observed = std::sqrt(stated / observed);
  return lengths / static_cast<double>(log.end() - half);
}

TEST(Engine, predicts_real_arms_on_poses_left_out) {
  if (!std::filesystem::exists(ARMSIG_SHARED_DATA)) GTEST_SKIP() << "no measured data";
  double ratio = 0;
  EXPECT_LT(score_other_half("ur5", "ur5-laser-tracker/grid.csv", 1, ratio), 0.055e-3);
  EXPECT_NEAR(ratio, 1, 0.17);
  EXPECT_LT(score_other_half("ur10", "ur10-laser-tracker/poses.csv", 1, ratio), 0.090e-3);
  EXPECT_NEAR(ratio, 1, 0.17);
}

}  // namespace
}  // namespace armsig::calibration
