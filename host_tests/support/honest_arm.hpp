// SPDX-License-Identifier: MIT
// A master and drives as they are: gravity pulls, motors coast, brakes take their time.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/pose.hpp"
#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::test {

inline constexpr double kHonestCountsPerRadian = 400000 / (2 * kPi);  // of puma_axis()

inline simulated::DriveConfiguration honest_drive() {
  return simulated::honest_drive(1, kHonestCountsPerRadian);
}

struct HonestArm : EmulatedArm {
  explicit HonestArm(std::uint8_t axes = 3,
                     const simulated::DriveConfiguration& drive = honest_drive())
      : HonestArm(puma_drives(axes), drive) {}
  explicit HonestArm(const canopen::Configuration& configuration,
                     const simulated::DriveConfiguration& drive = honest_drive())
      : EmulatedArm(configuration, nullptr, drive) {}

  // Accelerates every joint to `speed` rad/s at 5 rad/s^2, as a planner would.
  void move_at(double speed) {
    double rate = 0;
    for (int i = 0; i < 1000 && std::fabs(rate - speed) > 1e-9; ++i) {
      rate += std::clamp(speed - rate, -0.01, 0.01);
      tick([&] {
        for (double& target : targets) target += rate * hal::seconds(period);
      });
    }
  }
  [[nodiscard]] double speed(std::size_t joint) const {
    return drives[joint].velocity() / kHonestCountsPerRadian;
  }
  [[nodiscard]] double place(std::size_t joint) const {
    return drives[joint].position() / kHonestCountsPerRadian;
  }
};

}  // namespace armsig::test
