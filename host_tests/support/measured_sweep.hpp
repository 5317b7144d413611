// SPDX-License-Identifier: MIT
// A sweep of known truth, measured into an estimator.
#pragma once

#include <gtest/gtest.h>

#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::test {

inline const features::SweepConfig kRevoluteSweep{.type = JointType::kRevolute};
inline const features::SweepConfig kPrismaticSweep{.type = JointType::kPrismatic};
inline constexpr features::Method kBothMethods[] = {features::Method::kPaper,
                                                    features::Method::kEncoder};

inline features::SweepConfig by(features::Method method, features::SweepConfig config) {
  config.method = method;
  return config;
}

struct Sweep {
  TrueMotion motion;
  double range = 0;
  std::size_t count = 0;
  double noise_m = 0;
  double stated_m = 0;
};

inline TrueMotion some_motion(JointType type, double radius_m = 0.5) {
  Random random(1);
  TrueMotion motion = random_motion(type, random);
  motion.radius_m = radius_m;
  return motion;
}

inline features::SweepEstimator measured(const features::SweepConfig& config, const Sweep& sweep) {
  Random random(2);
  features::SweepEstimator estimator(config);
  for (std::size_t i = 0; i < sweep.count; ++i) {
    const double reading = even_reading(sweep.motion, sweep.range, i, sweep.count);
    const Vector3 p_S = sweep.motion.at(reading) + sweep.noise_m * random.normal_vector();
    EXPECT_TRUE(estimator.add(reading, p_S, isotropic(sweep.stated_m)));
  }
  return estimator;
}

}  // namespace armsig::test
