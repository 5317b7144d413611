// SPDX-License-Identifier: MIT
// The virtual cabinet of a Puma 560: robot 1 of Table 2 behind emulated drives.
#pragma once

#include <memory>
#include <string>

#include "firmware/paper_arms/paper_arms.hpp"
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"
#include "hal/simulated/demo_sensor.hpp"
#include "host_tests/support/line_console.hpp"
#include "host_tests/support/ram_memory.hpp"

namespace armsig::test {

inline JointVector puma_configuration() {
  return {radians(0), radians(-90), radians(90), radians(30), radians(0), radians(0)};
}

// A box around the whole arm, whose links are lines.
inline clearance::Surroundings boxed(const Vector3& lower_B, const Vector3& upper_B,
                                     double hand_m) {
  clearance::Surroundings around;
  around.lower_B = lower_B;
  around.upper_B = upper_B;
  around.hand_m = hand_m;
  return around;
}

inline controller::Configuration puma_controller() {
  controller::Configuration c;
  c.drawing = tool::puma560();
  for (std::size_t i = 0; i < 6; ++i) {
    c.limits.speed.push_back(1.0);
    c.limits.acceleration.push_back(3.0);
    c.supervision.following_error.push_back(0.05);
  }
  for (const Vector3& p_S : simulated::demo_sensor().receivers_S) {
    c.sensor.receivers.p_S.push_back(p_S);
  }
  c.sensor.receivers.range_sigma_m = simulated::kDemoRangeSigma;
  c.sensor.receivers.facing_S = simulated::demo_sensor_facing();
  c.dwell.tolerance = 1e-4;
  c.sweeps.configuration = puma_configuration();
  c.sweeps.arc_rad = radians(180);
  return c;
}

inline canopen::Configuration puma_bus() {
  canopen::Configuration c;
  const Arm drawing = tool::puma560();
  for (std::uint8_t i = 0; i < 6; ++i) {
    c.axes.push_back({{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
                       .limits = drawing.limits[i],
                       .largest_speed = 2.0},
                      static_cast<std::uint8_t>(i + 1)});
  }
  return c;
}

// Two joints a node.
inline canopen::Configuration puma_bus_of_dual_drives() {
  canopen::Configuration c = puma_bus();
  for (std::uint8_t i = 0; i < 6; ++i) {
    c.axes[i].node = static_cast<std::uint8_t>(i / 2 + 1);
    c.axes[i].axis = static_cast<std::uint8_t>(i % 2 + 1);
  }
  return c;
}

inline cabinet::World puma_world(std::uint64_t seed = 1) {
  cabinet::World world;
  world.arm.arm = tool::table2_robot(1);
  world.arm.X_S0 = simulated::demo_base_pose();
  world.arm.targets.push_back({.number = 1, .link = 6, .p_L = {0.15, 0.0, 0.05}});
  world.start = puma_configuration();
  world.sensor = simulated::demo_sensor();
  world.seed = seed;
  return world;
}

inline constexpr double kPumaCountsPerRadian = 400000 / (2 * kPi);

// Drives as they are, for every joint.
inline simulated::DriveConfiguration honest_puma_drive() {
  return simulated::honest_drive(1, kPumaCountsPerRadian);
}

struct PumaCabinet {
  explicit PumaCabinet(std::uint64_t seed = 1,
                       const controller::Configuration& configuration = puma_controller(),
                       const simulated::DriveConfiguration& of_drives = {})
      : drives(of_drives) {
    start(configuration, seed);
  }
  // Power-up, again if it ran already: the memory keeps what it holds.
  void start(const controller::Configuration& configuration, std::uint64_t seed) {
    cabinet.reset();
    cabinet::World world = puma_world(seed);
    world.drive = drives;
    world.sensor.receivers_S.clear();
    for (const Vector3& p_S : configuration.sensor.receivers.p_S) {
      world.sensor.receivers_S.push_back(p_S);
    }
    if (configuration.sensor.measures == controller::Measures::kPoints) {
      world.sensor.range_sigma_m = configuration.sensor.point_sigma_m;
    }
    world.points = points;
    world.length_offsets_m = length_offsets_m;
    world.first_serial = first_serial;
    cabinet = std::make_unique<cabinet::VirtualCabinet>(configuration, puma_bus(), world, *device,
                                                        consoles, nullptr, nullptr, checks);
  }
  void run(double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) cabinet->step();
  }
  [[nodiscard]] const controller::Snapshot& now() const { return cabinet->state().snapshot(); }
  [[nodiscard]] controller::Mode mode() const { return now().mode; }
  bool run_until(controller::Mode mode_wanted, double seconds = 10) {
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      if (mode() == mode_wanted) return true;
      cabinet->step();
    }
    return mode() == mode_wanted;
  }
  // The reply to `request`; empty if none comes within a second.
  std::string ask(const std::string& request) { return ask(console, request); }
  std::string ask(LineConsole& from, const std::string& request) {
    const std::size_t before = from.replies.size();
    from.requests.push_back(request);
    for (int i = 0; i < 500 && from.replies.size() == before; ++i) cabinet->step();
    return from.replies.size() == before ? "" : from.replies.back();
  }
  // A person has looked at the joints that may stand elsewhere.
  void confirm() {
    for (std::size_t i = 0; i < now().positions.size(); ++i) {
      if ((cabinet->state().unreferenced() >> i & 1U) == 0) continue;
      (void)ask("confirm q" + std::to_string(i + 1) +
                "_deg=" + std::to_string(degrees(now().positions[i])));
    }
  }
  bool enable() {
    return run_until(controller::Mode::kIdle) && ask("enable") == "ok" &&
           run_until(controller::Mode::kHolding);
  }
  // Enabled, and standing with its wrist bent, where straight lines can begin.
  bool bend_wrist() {
    return enable() && ask("move q3_deg=10 q5_deg=40") == "ok" &&
           run_until(controller::Mode::kServoing, 0.1) && run_until(controller::Mode::kHolding);
  }

  LineConsole console;
  LineConsole other;  // a second operator's
  std::array<hal::Console*, 2> consoles{&console, &other};
  RamMemory memory;
  simulated::DriveConfiguration drives;
  // From the next start on.
  hal::NonvolatileMemory* device = &memory;
  std::uint32_t first_serial = 1001;  // of the drives
  controller::CheckMemory* checks = nullptr;
  hal::PointInstrument* points = nullptr;
  controller::LengthOffsets length_offsets_m;
  std::unique_ptr<cabinet::VirtualCabinet> cabinet;
};

}  // namespace armsig::test
