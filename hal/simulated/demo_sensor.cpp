// SPDX-License-Identifier: MIT
#include "hal/simulated/demo_sensor.hpp"

namespace armsig::simulated {

UltrasonicConfig demo_sensor() {
  UltrasonicConfig config;
  config.receivers_S = {
      {-1.0, -1.0, 0.0}, {1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}, {-1.0, 1.0, 0.0},
      {-0.5, -0.5, 0.8}, {0.5, -0.5, 0.8}, {0.5, 0.5, 0.8}, {-0.5, 0.5, 0.8},
  };
  config.range_sigma_m = kDemoRangeSigma;
  return config;
}

Pose demo_base_pose() {
  return {rotation_z(radians(30)) * rotation_x(radians(2)), Vector3(0.05, -0.03, -1.2)};
}

}  // namespace armsig::simulated
