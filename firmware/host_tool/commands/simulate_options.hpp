// SPDX-License-Identifier: MIT
// What `armsig simulate` is told.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "firmware/host_tool/commands/command.hpp"

namespace armsig::tool {

struct SimulateOptions : CommonOptions {
  std::string arm, truth, tolerances, sensor, out, truth_out;
  double arc_deg = 180;
  std::size_t points = 36;
  double sigma_mm = 0.2;
  std::size_t mixed_poses = 0;
  std::size_t pings = 1;
  double target_radius_mm = 300;
  double outliers = 0;
  double dropouts = 0;
  double air_c = 20;
  double thermometer_error_c = 0;
  double bias_mm = 0;
  double maps_deg = 0;
  double sag_mm = 0;
  double play_deg = 0;
  std::uint64_t seed = 1;
  std::vector<double> hand_target_mm;
  std::vector<double> configuration;  // degrees and millimetres, by joint type
};

void add_simulate_options(CLI::App& command, SimulateOptions& options);

}  // namespace armsig::tool
