// SPDX-License-Identifier: MIT
#include "core/kinematics/joint_box.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::kinematics {

JointBox joint_box(const Chain& chain, const JointVector& seed, const InverseOptions& options) {
  JointBox box;
  const bool limited = options.respect_limits && !chain.limits.empty();
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (limited) {
      box.lower[k] = chain.limits[i].lower;
      box.upper[k] = chain.limits[i].upper;
    }
    if (options.max_step.empty()) continue;
    // Rounded towards the seed: not an ulp above the step.
    double lowest = seed[i] - options.max_step[i];
    double highest = seed[i] + options.max_step[i];
    if (seed[i] - lowest > options.max_step[i]) lowest = std::nextafter(lowest, seed[i]);
    if (highest - seed[i] > options.max_step[i]) highest = std::nextafter(highest, seed[i]);
    if (lowest > box.lower[k]) {
      box.lower[k] = lowest;
      box.lower_is_step[i] = true;
    }
    if (highest < box.upper[k]) {
      box.upper[k] = highest;
      box.upper_is_step[i] = true;
    }
    box.lower[k] = std::min(box.lower[k], highest);
    box.upper[k] = std::max(box.upper[k], lowest);
  }
  return box;
}

}  // namespace armsig::kinematics
