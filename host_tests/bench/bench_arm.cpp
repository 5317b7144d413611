// SPDX-License-Identifier: MIT
// armsig_bench_arm: an emulated arm on SocketCAN with its range sensor, as a process of its own.
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "firmware/formats/arm_file.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "hal/linux/real_time.hpp"
#include "hal/linux/socket_console.hpp"
#include "hal/linux/steady_clock.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "host_tests/bench/commands.hpp"
#include "host_tests/bench/plant.hpp"
#include "host_tests/bench/point_bridge.hpp"

namespace armsig::bench {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

struct Options {
  std::string console;
  std::string truth;
  std::string drive_tables;
  std::string drive;
  int robot = 1;
  std::vector<double> start_deg;
  std::vector<double> target_mm{30, 20, 120};
  double sigma_mm = 1e3 * simulated::kDemoRangeSigma;
  double ping_ms = 20;
  double step_us = 1000;
  int priority = 0;
  int sensor_node = 0;
  std::uint16_t points_port = 0;  // 0: no tracker
  double maps_deg = 0;
  double sag_mm = 0;
  double play_deg = 0;
  PlantConfiguration plant;
};

// The arm as it was built, hung under the sensor as in the demonstration.
simulated::SimulatedArm arm_of(const Options& options) {
  simulated::SimulatedArm arm{
      .arm = tool::table2_robot(options.robot), .X_S0 = simulated::demo_base_pose(), .targets = {}};
  if (!options.truth.empty()) {
    const auto truth = tool::read_arm_file(options.truth);
    if (!truth) throw CLI::ValidationError(tool::render(truth.error()));
    arm.arm = truth->arm;
  }
  const Vector3 p_mm(options.target_mm[0], options.target_mm[1], options.target_mm[2]);
  arm.targets.push_back({1, arm.arm.joints.size(), 1e-3 * p_mm});
  return arm;
}

void bend(const Options& options, PlantConfiguration& plant) {
  constexpr std::uint64_t kBendStream = 2;  // of the seed, as of armsigd --virtual
  const cabinet::Bends bends{.map_rad = radians(options.maps_deg),
                             .sag_m = 1e-3 * options.sag_mm,
                             .play_rad = radians(options.play_deg)};
  plant.play_rad = bends.play_rad;
  if (bends.map_rad == 0 && bends.sag_m == 0) return;
  simulated::Random random(plant.seed, kBendStream);
  const Arm drawing = options.truth.empty() ? tool::puma560() : plant.arm.arm;
  plant.bent = cabinet::bent_model(drawing, bends, random);
}

// The table of `--drives` whose name begins so.
void take_drive(const Options& options, PlantConfiguration& plant) {
  if (options.drive_tables.empty()) return;
  std::string names;
  for (const test::DriveTable& table : test::read_drive_tables(options.drive_tables)) {
    if (table.name.starts_with(options.drive)) {
      plant.counts_per_revolution = table.counts_per_revolution;
      plant.drive_table = table;
      return;
    }
    names += "\n  " + table.name;
  }
  throw CLI::ValidationError(
      fmt::format("--drive {}: {} has{}", options.drive, options.drive_tables, names));
}

// Checks what the options say together; CLI11 has checked each.
PlantConfiguration plant_of(Options& options) {
  PlantConfiguration& plant = options.plant;
  plant.arm = arm_of(options);
  const std::size_t joints = plant.arm.arm.joints.size();
  if (options.start_deg.empty()) options.start_deg.assign(joints, 0.0);
  if (plant.zero_counts.empty()) plant.zero_counts.assign(joints, 0.0);
  if (options.start_deg.size() != joints || plant.zero_counts.size() != joints) {
    throw CLI::ValidationError(fmt::format("--start-deg and --zero-counts need {} values", joints));
  }
  for (const double start_deg : options.start_deg) plant.start.push_back(radians(start_deg));
  plant.sensor_node = static_cast<std::uint8_t>(options.sensor_node);
  plant.ping_period = hal::Duration(std::llround(1e6 * options.ping_ms));
  plant.field = simulated::demo_sensor();
  plant.field.range_sigma_m = 1e-3 * options.sigma_mm;
  bend(options, plant);
  take_drive(options, plant);
  return plant;
}

void serve(const Options& options, Plant& plant) {
  const hal::Duration step(std::llround(1e3 * options.step_us));
  auto console = linux_hal::SocketConsole::open(options.console);
  if (!console) {
    throw CLI::ValidationError(options.console + ": " + std::string(describe(console.error())));
  }
  // Late answers would be a fault of the bench and not of what is tested on it.
  (void)linux_hal::become_real_time(options.priority);
  fmt::print("# {} drives on {}, requests at {}\n", plant.joints(), options.plant.can_interface,
             options.console);
  std::fflush(stdout);
  linux_hal::SteadyClock clock;
  std::optional<PointBridge> bridge;
  if (options.points_port != 0) {
    bridge.emplace(options.points_port, options.plant.ping_period, 1e-3 * options.sigma_mm,
                   options.plant.seed);
  }
  while (stop_requested == 0) {
    plant.run(clock.now());
    if (bridge) bridge->run(clock.now(), plant.target_S());
    if (const auto line = (*console)->read_line()) {
      const std::string reply = line->error ? "error REQUEST " + std::string(describe(*line->error))
                                            : answer(plant, line->text());
      (void)(*console)->write_line(line->client, reply);
    }
    clock.wait_until(clock.now() + step);
  }
}

int run(int argc, char** argv) {
  CLI::App app{
      "An emulated arm: drives on SocketCAN, its range sensor on a serial line and on CAN.",
      "armsig_bench_arm"};
  Options options;
  PlantConfiguration& plant = options.plant;
  app.add_option("--can", plant.can_interface, "CAN interface")->capture_default_str();
  app.add_option(
      "--second-can", plant.second_can_interface,
      "CAN interface that the drives of the upper half of the joints are on, their nodes "
      "counted from 1 too");
  app.add_option("--console", options.console, "Unix socket for requests")->required();
  app.add_option("--sensor-device", plant.sensor_device,
                 "symbolic link to make to the sensor's serial line (Modbus RTU)");
  app.add_option("--sensor-node", options.sensor_node, "node number of the sensor on CAN")
      ->check(CLI::Range(1, 127));
  app.add_option("--points-port", options.points_port,
                 "TCP port of this computer where a tracker's points are told")
      ->check(CLI::Range(1024, 65535));
  app.add_option("--robot", options.robot, "robot of Table 2 of the paper that the arm is")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  app.add_option("--truth", options.truth, "arm description (YAML) that the arm is instead");
  CLI::Option* tables =
      app.add_option("--drive-tables", options.drive_tables,
                     "table (CSV) of what drives have, as host_tests/support/drives.csv");
  app.add_option("--drive", options.drive,
                 "--drive-tables: the begin of the name of the drive that all joints have")
      ->needs(tables);
  app.add_flag("--dual", plant.dual, "drives that move two joints each, by two axes in a node");
  app.add_option("--homed", plant.homed,
                 "joints whose drives count from power-up on until they have homed, where they "
                 "would count zero")
      ->delimiter(',');
  app.add_option("--start-deg", options.start_deg, "readings at power-up")->delimiter(',');
  app.add_option("--zero-counts", plant.zero_counts, "counts where a reading is zero")
      ->delimiter(',');
  app.add_option("--counts-per-revolution", plant.counts_per_revolution, "of the motors")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--gear-ratio", plant.gear_ratio, "motor revolutions a revolution of the joint")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--bandwidth-hz", plant.bandwidth_hz, "of the position loops")
      ->check(CLI::Range(1.0, 100.0))
      ->capture_default_str();
  app.add_option("--sync-loss", plant.sync_loss_periods,
                 "missing SYNC periods that make an enabled drive fault; 0: any number is borne")
      ->capture_default_str();
  app.add_flag("--ideal", plant.ideal,
               "exact drives, without gravity, coasting, slow brakes, gentle ramps and play");
  const auto add_bend = [&](const char* name, double& value, const char* what) {
    app.add_option(name, value, what)->check(CLI::Range(0.0, 10.0));
  };
  add_bend("--maps-deg", options.maps_deg, "largest error of each joint's reading, over the turn");
  add_bend("--deflection-mm", options.sag_mm,
           "how far gravity deflects the arm, stretched out level");
  add_bend("--backlash-deg", options.play_deg, "play of each joint, beside what its drive has");
  app.add_option("--target-mm", options.target_mm, "the emitter in the frame of the last link")
      ->expected(3)
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--sigma-mm", options.sigma_mm,
                 "noise of a range, or of a point along each axis, 1 sigma")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--ping-ms", options.ping_ms, "from one ping of the sensor to the next")
      ->check(CLI::Range(1.0, 1000.0))
      ->capture_default_str();
  app.add_option("--step-us", options.step_us,
                 "from one look at the buses to the next; a small part of the master's period")
      ->check(CLI::Range(50.0, 5000.0))
      ->capture_default_str();
  app.add_option("--priority", options.priority, "SCHED_FIFO; 0: ordinary scheduling")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  app.add_option("--seed", plant.seed, "of the noise")->capture_default_str();
  try {
    app.parse(argc, argv);
    Plant running(plant_of(options), linux_hal::monotonic_now());
    serve(options, running);
  } catch (const CLI::Error& error) {
    constexpr int kWrongUsage = 2;
    return app.exit(error) == 0 ? 0 : kWrongUsage;
  }
  return 0;
}

}  // namespace
}  // namespace armsig::bench

int main(int argc, char** argv) {
  const auto stop = [](int) { armsig::bench::stop_requested = 1; };
  std::signal(SIGTERM, stop);
  std::signal(SIGINT, stop);
  try {
    return armsig::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "armsig_bench_arm: %s\n", error.what());
    return 1;
  }
}
