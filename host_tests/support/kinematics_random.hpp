// SPDX-License-Identifier: MIT
// Random readings and arms for the kinematics tests.
#pragma once

#include <algorithm>
#include <random>

#include "core/base/arm.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::test {

inline double uniform(std::mt19937_64& random, double lower, double upper) {
  return std::uniform_real_distribution(lower, upper)(random);
}

// Uniform over the limits.
inline JointVector random_readings(const KnownArm& arm, std::mt19937_64& random) {
  JointVector q;
  for (const JointLimits& limit : arm.limits) {
    q.push_back(uniform(random, limit.lower, limit.upper));
  }
  return q;
}

// Each reading of `q` moved by at most `most`, inside the limits.
inline JointVector disturbed(const KnownArm& arm, const JointVector& q, double most,
                             std::mt19937_64& random) {
  JointVector seed;
  for (std::size_t i = 0; i < q.size(); ++i) {
    seed.push_back(
        std::clamp(q[i] + uniform(random, -most, most), arm.limits[i].lower, arm.limits[i].upper));
  }
  return seed;
}

// The Puma as built: parameters drawn about Table 1 (alpha 0.1 deg, theta 0.2 deg, lengths 0.5 mm).
inline KnownArm perturbed_puma(std::mt19937_64& random) {
  KnownArm arm = puma560();
  std::normal_distribution<double> normal;
  for (DhJoint& row : arm.joints) {
    row.alpha_rad += radians(0.1) * normal(random);
    row.theta_rad += radians(0.2) * normal(random);
    row.a_m += 5e-4 * normal(random);
    row.d_m += 5e-4 * normal(random);
  }
  return arm;
}

}  // namespace armsig::test
