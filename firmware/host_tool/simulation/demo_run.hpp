// SPDX-License-Identifier: MIT
// Simulated arms for the whole story: swept, and judged by touching the grid.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware/analysis/evaluation/comparison.hpp"
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

// A simulated arm, and what the sensor saw of it.
struct DemoRobot {
  std::string name;
  Signature truth;
  double drawing_error_m = 0;  // RMS tool error of the drawing, its base and tool fitted
  double sweep_duration_s = 0;
  std::vector<MeasurementRow> rows;
};

// Robot 0 and 1: the robots of Table 2. Others: drawn about Table 1 with the usual tolerances, each
// with its own seed. `noise_seed` repeats the measurement of the same robot.
[[nodiscard]] DemoRobot measured_demo_robot(std::size_t robot, std::uint64_t noise_seed,
                                            const DemoPlan& plan = {});

// A signature found of a robot, against the truth.
struct DemoScore {
  evaluation::Comparison grid;
  double tool_error_m = 0;  // RMS over the joint space
};
[[nodiscard]] Read<DemoScore> score_of(const DemoRobot& robot, const Signature& found);

// The sensor that measures.
[[nodiscard]] SensorDescription demo_sensor_description();

}  // namespace armsig::tool
