// SPDX-License-Identifier: MIT
// Checks of simulated arms under what a plant does to them, and the settings that are to find a
// drift of 0.1 mm among them. The world is simulated by nothing of what computes the threshold.
#pragma once

#include <cmath>

#include <gtest/gtest.h>

#include "core/drift/cusum.hpp"
#include "firmware/analysis/evaluation/threshold.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::drift::test {

inline constexpr int kPoses = 20;
inline constexpr double kTold =
    0.1e-3 / 1.1;                         // of a pose; it is up to 0.1 mm: told a tenth too small
inline constexpr double kWarm = 0.01e-3;  // the tool of a cold arm is there
inline constexpr Scatter kExpected{.baseline = 20, .correlation = 0.3, .sigma_ratio = 1.1};

// One arm: noise of 0.05 to 0.1 mm a pose, checks correlated by 0.3, each taken somewhere on the
// way from cold to warm, and a reference of twenty of them.
class SimulatedArm {
 public:
  explicit SimulatedArm(simulated::Random& random)
      : random_(random),
        sigma_m_(check_sigma(random.uniform(0.05e-3, 0.1e-3), kPoses)),
        cold_(random.direction()),
        noise_(random.normal_vector()) {
    for (int i = 0; i < kExpected.baseline; ++i) reference_ += draw() / kExpected.baseline;
  }

  Vector3 check() { return draw() - reference_; }

 private:
  Vector3 draw() {
    noise_ = 0.3 * noise_ + std::sqrt(1 - 0.09) * random_.normal_vector();
    return sigma_m_ * noise_ + kWarm * std::exp(-3 * random_.uniform()) * cold_;
  }

  simulated::Random& random_;
  double sigma_m_;
  Vector3 cold_;
  Vector3 noise_;
  Vector3 reference_ = Vector3::Zero();
};

inline Settings settings_for(double checks_per_month) {
  Settings settings{.sigma_m = check_sigma(kTold, kPoses)};
  settings.reference = reference_value(0.1e-3, settings.sigma_m);
  const auto least =
      threshold(settings.reference, kExpected, {.checks_per_month = checks_per_month});
  EXPECT_TRUE(least);
  settings.threshold = least.value_or(0);
  return settings;
}

}  // namespace armsig::drift::test
