// SPDX-License-Identifier: MIT
#include "firmware/arm_r5f/world.hpp"

#include "firmware/cabinet_r5f/configuration.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "hal/simulated/random.hpp"

namespace armsig::arm_r5f {

simulated::SimulatedArm arm() {
  simulated::SimulatedArm built{
      .arm = tool::table2_robot(1), .X_S0 = simulated::demo_base_pose(), .targets = {}};
  built.targets.push_back({.number = 1, .link = 6, .p_L = {0.15, 0.0, 0.05}});
  return built;
}

JointVector start() { return {0, radians(-80), radians(80), radians(20), radians(10), 0}; }

simulated::UltrasonicConfig field(std::uint64_t seed) {
  simulated::UltrasonicConfig config;
  simulated::Random random(seed);
  for (const Vector3& p_S : cabinet::receivers_S()) {
    config.receivers_S.push_back(p_S);
    config.bias_m.push_back(simulated::kDemoRangeSigma * random.normal());
  }
  return config;
}

}  // namespace armsig::arm_r5f
