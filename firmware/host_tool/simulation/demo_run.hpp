// SPDX-License-Identifier: MIT
// The whole story on simulated arms: sweep, identify by both methods, touch the grid.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

#include "core/evaluation/comparison.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/sensor_file.hpp"
#include "firmware/host_tool/simulation/simulation.hpp"

namespace armsig::tool {

// How the demonstration measures: the paper's kind of sensor, 120 points a joint.
struct DemoPlan {
  double arc_rad = 2 * kPi;  // as far as each joint's limits allow
  std::size_t points = 120;
  std::size_t pings = 4;
  double target_radius_m = 0.3;
};

struct DemoMethod {
  Signature signature;
  evaluation::Comparison grid;
  double tool_error_m = 0;  // RMS over the joint space
};

struct DemoRobot {
  std::string name;
  Signature truth;
  DemoMethod paper;
  DemoMethod encoder;
  double drawing_error_m = 0;  // RMS tool error of the drawing, its base and tool fitted
  std::size_t rejected = 0;
  double sweep_duration_s = 0;
};

// Robot 0 and 1: the robots of Table 2. Others: drawn about Table 1 with the usual tolerances, each
// with its own seed. `noise_seed` repeats the measurement of the same robot. `watch`, where there
// is one, sees every measured row.
[[nodiscard]] Read<DemoRobot> run_demo_robot(
    std::size_t robot, std::uint64_t noise_seed,
    const std::function<void(const MeasurementRow&)>& watch = {}, const DemoPlan& plan = {});

// The sensor that measures.
[[nodiscard]] SensorDescription demo_sensor_description();

}  // namespace armsig::tool
