// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/deviation_words.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace armsig::tool {

std::string deviation_in_words(const NearFit& fit, const ArmLimits& limits, const Arm& arm) {
  const double shift_m = std::max(limits.least_shift_m, limits.shift_share * fit.reach_m);
  std::string words;
  double worst = 0;
  for (std::size_t j = 0; j < fit.joints.size(); ++j) {
    const Deviation& joint = fit.joints[j];
    const auto say = [&](double share, std::string said) {
      if (share <= worst) return;
      worst = share;
      words = std::move(said);
    };
    say(joint.tilt_rad / limits.tilt_rad,
        fmt::format(
            "the axis after joint {} is tilted by {:.2f}° from the nominal model's, {:.2f}° are "
            "allowed",
            j + 1, degrees(joint.tilt_rad), degrees(limits.tilt_rad)));
    say(joint.shift_m / shift_m,
        fmt::format(
            "the axis after joint {} is {:.1f} mm from the nominal model's, {:.1f} mm are allowed",
            j + 1, 1e3 * joint.shift_m, 1e3 * shift_m));
    if (arm.joints[j].type == JointType::kRevolute) {
      say(std::abs(joint.zero) / limits.zero_rad,
          fmt::format(
              "the zero of joint {} is {:.1f}° from the nominal model's, {:.0f}° are allowed",
              j + 1, degrees(joint.zero), degrees(limits.zero_rad)));
    }
  }
  return words;
}

}  // namespace armsig::tool
