// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/simulate_options.hpp"

namespace armsig::tool {
namespace {

// The arm as built.
void add_arm_options(CLI::App& command, SimulateOptions& options) {
  auto* truth = command.add_option("--truth", options.truth,
                                   "the arm as it was built: an arm description or a signature");
  command
      .add_option("--tolerances", options.tolerances,
                  "draw the arm about the nominal model, 1 sigma: a factor of the usual tolerances "
                  "(1 is alpha 0.1°, theta 0.2°, a and d 0.5 mm), or a list such as "
                  "alpha_deg=0.1,theta_deg=0.2,a_mm=0.5,d_mm=0.5")
      ->excludes(truth);
}

// The sweeps, and the noise of each of their points.
void add_sweep_options(CLI::App& command, SimulateOptions& options) {
  command.add_option("--arc", options.arc_deg, "degrees that each revolute joint is swept")
      ->check(CLI::Range(0.1, 360.0))
      ->capture_default_str();
  command.add_option("--points", options.points, "points a sweep")
      ->check(CLI::Range(std::size_t{2}, std::size_t{100'000'000}))
      ->capture_default_str();
  command
      .add_option("--sigma-mm", options.sigma_mm,
                  "noise, 1 sigma: per axis of a position, or per range with --sensor")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      .add_option("--configuration", options.configuration,
                  "signature configuration, degrees or mm a joint, separated by commas "
                  "(default: the middle of the limits)")
      ->delimiter(',');
}

// The targets, and the poses beside the sweeps.
void add_target_options(CLI::App& command, SimulateOptions& options) {
  auto* radius = command.add_option("--target-radius-mm", options.target_radius_mm,
                                    "a target on each link, this far from the axis of its joint");
  radius->check(CLI::PositiveNumber)->capture_default_str();
  command
      .add_option("--flange-target-mm", options.hand_target_mm,
                  "one target for all sweeps instead: x,y,z in the frame of the last link")
      ->delimiter(',')
      ->expected(3)
      ->excludes(radius);
  command
      .add_option("--free-poses", options.mixed_poses,
                  "further rows (sweep 0) with all joints anywhere within their limits")
      ->check(CLI::Range(std::size_t{0}, std::size_t{100'000'000}))
      ->capture_default_str();
}

// The sensor, and what it does wrong.
void add_sensor_options(CLI::App& command, SimulateOptions& options) {
  command.add_option("--sensor", options.sensor,
                     "sensor description (YAML): write ranges to its receivers, not positions");
  command.add_option("--pings", options.pings, "pings a point; the median counts")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  command
      .add_option("--outliers", options.outliers,
                  "share of positions, or of single ranges, that are wrong by 20 to 300 mm")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--dropouts", options.dropouts, "share of positions or ranges not heard")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command.add_option("--air-c", options.air_c, "air temperature")->capture_default_str();
  command
      .add_option("--thermometer-error-c", options.thermometer_error_c,
                  "what the sensor's thermometer reads too much")
      ->capture_default_str();
  command.add_option("--bias-mm", options.bias_mm, "constant error of every range")
      ->capture_default_str();
}

// What the joints do beside what they read.
void add_bend_options(CLI::App& command, SimulateOptions& options) {
  command
      .add_option("--maps-deg", options.maps_deg,
                  "largest error of each joint's reading, by 1 to 17 periods a turn")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_option("--deflection-mm", options.sag_mm,
                  "how far gravity deflects the arm, stretched out level, its base upright")
      ->check(CLI::Range(0.0, 20.0))
      ->capture_default_str();
  command
      .add_option("--backlash-deg", options.play_deg,
                  "backlash of each joint, which stays on the side that it came from")
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
}

}  // namespace

void add_simulate_options(CLI::App& command, SimulateOptions& options) {
  command
      .add_option("--arm", options.arm,
                  "arm description (YAML), or a name that `armsig arms` lists: the nominal model")
      ->required();
  add_arm_options(command, options);
  add_sweep_options(command, options);
  add_target_options(command, options);
  add_sensor_options(command, options);
  add_bend_options(command, options);
  command.add_option("--seed", options.seed, "the same seed gives the same file")
      ->capture_default_str();
  command.add_option("-o,--out", options.out, "measurements to write (CSV)")->required();
  command.add_option("--truth-out", options.truth_out, "signature file to write: the exact arm");
}

}  // namespace armsig::tool
