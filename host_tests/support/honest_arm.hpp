// SPDX-License-Identifier: MIT
// A master and drives as they are: gravity pulls, motors coast, brakes take their time.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/pose.hpp"
#include "hal/simulated/gravity.hpp"
#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::test {

inline constexpr double kHonestCountsPerRadian = 400000 / (2 * kPi);  // of puma_axis()

inline simulated::DriveConfiguration honest_drive() {
  return simulated::honest_drive(1, kHonestCountsPerRadian);
}

// An arm of Puma's measures on a wall, so that gravity pulls at every joint in some pose.
inline simulated::SimulatedArm arm_on_a_wall(std::size_t joints) {
  const std::array<DhJoint, 6> rows{{{.alpha_rad = radians(-90)},
                                     {.d_m = 0.149, .a_m = 0.432},
                                     {.a_m = -0.02, .alpha_rad = radians(90)},
                                     {.d_m = 0.431, .alpha_rad = radians(-90)},
                                     {.alpha_rad = radians(90)},
                                     {.d_m = 0.1}}};
  simulated::SimulatedArm arm;
  for (std::size_t i = 0; i < joints; ++i) arm.arm.joints.push_back(rows[i]);
  arm.X_S0 = {rotation_x(radians(90)), Vector3::Zero()};
  return arm;
}

// Pulls at the motors of a HonestArm, by its pose.
class Gravity final : public simulated::TimeDriven {
 public:
  explicit Gravity(std::deque<simulated::Drive>& drives)
      : drives_(drives), arm_(arm_on_a_wall(drives.size())) {
    do_advance({});
  }

  // rad/s^2 of a joint that nothing holds.
  [[nodiscard]] double pull(std::size_t joint) const { return pull_[joint]; }

 private:
  void do_advance(hal::Instant /*until*/) override {
    JointVector readings;
    for (const simulated::Drive& drive : drives_) {
      readings.push_back(drive.joint_position() / kHonestCountsPerRadian);
    }
    pull_ = simulated::gravity_pull(arm_, readings);
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      drives_[i].set_gravity(pull_[i] * kHonestCountsPerRadian);
    }
  }

  std::deque<simulated::Drive>& drives_;
  simulated::SimulatedArm arm_;
  JointVector pull_;
};

struct HonestArm : EmulatedArm {
  explicit HonestArm(std::uint8_t axes = 3,
                     const simulated::DriveConfiguration& drive = honest_drive())
      : HonestArm(puma_drives(axes), drive) {}
  explicit HonestArm(const canopen::Configuration& configuration,
                     const simulated::DriveConfiguration& drive = honest_drive())
      : EmulatedArm(configuration, nullptr, drive), gravity(drives) {
    clock.add(gravity);
  }

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

  Gravity gravity;
};

}  // namespace armsig::test
