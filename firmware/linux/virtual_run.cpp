// SPDX-License-Identifier: MIT
#include "firmware/linux/virtual_run.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "firmware/controller/position_keeper.hpp"
#include "firmware/controller/record_store.hpp"
#include "firmware/linux/attendance.hpp"
#include "firmware/linux/check_file.hpp"
#include "firmware/linux/daemon.hpp"
#include "firmware/linux/places.hpp"
#include "firmware/linux/real_time_loop.hpp"
#include "firmware/linux/self_calibrating.hpp"
#include "firmware/virtual_cabinet/emulation_console.hpp"
#include "firmware/virtual_cabinet/virtual_cabinet.hpp"
#include "hal/linux/steady_clock.hpp"
#include "hal/simulated/placement.hpp"
#include "hal/simulated/tolerances.hpp"

namespace armsig::daemon {
namespace {

constexpr std::uint64_t kBendStream = 2;  // of the seed; 0: tolerances
constexpr double kSteelGrowth_per_kelvin = 12e-6;

// Where the arm was left, as a real one would stay; at first the signature configuration.
JointVector start_of(const controller::Configuration& c, hal::NonvolatileMemory& store) {
  controller::PositionKeeper keeper(store, controller::RecordStore(store).sectors());
  const auto kept = keeper.load(c.drawing.joints.size());
  return kept ? kept->positions : c.sweeps.configuration;
}

cabinet::World world_of(const DaemonConfiguration& configuration, const VirtualOptions& options,
                        hal::NonvolatileMemory& store) {
  const controller::Configuration& c = configuration.controller;
  simulated::Random random(options.seed);
  cabinet::World world;
  world.arm.arm = options.truth ? *options.truth : simulated::drawn_arm(c.drawing, {}, random);
  world.arm.arm.up_0 = c.drawing.up_0;
  world.arm.targets.push_back(
      {.number = c.sweeps.target, .link = c.drawing.joints.size(), .p_L = configuration.p_nT});
  const auto& receivers = c.sensor.receivers;
  world.arm.X_S0 = configuration.virtual_base.value_or(simulated::base_pose(
      world.arm, {receivers.p_S.data(), receivers.p_S.size()}, receivers.facing_S));
  world.limbs.g_S = -world.limbs.g_S.norm() * (world.arm.X_S0.R * c.drawing.up_0);
  if (options.ideal) world.drive.emplace();
  if (options.bends.map_rad > 0 || options.bends.sag_m > 0) {
    simulated::Random bends(options.seed, kBendStream);
    world.bent = cabinet::bent_model(c.drawing, options.bends, bends);
  }
  world.play_rad = options.bends.play_rad;
  world.growth = kSteelGrowth_per_kelvin * options.warm_kelvin;
  world.start = start_of(c, store);
  // Real ticks may be late: that is to be counted, and not to end by a fault of an emulated drive.
  if (options.real_time) world.sync_loss_periods = 0;
  for (const Vector3& p_S : c.sensor.receivers.p_S) world.sensor.receivers_S.push_back(p_S);
  world.sensor.range_sigma_m = c.sensor.measures == controller::Measures::kPoints
                                   ? c.sensor.point_sigma_m
                                   : c.sensor.receivers.range_sigma_m;
  world.length_offsets_m = configuration.length_offsets_m;
  world.sockets = configuration.virtual_sockets;
  world.seed = options.seed;
  return world;
}

void pace(cabinet::VirtualCabinet& cabinet, hal::Clock& clock, ProcessWatch& watch, double speed,
          const volatile std::sig_atomic_t& stop) {
  const hal::Instant real = clock.now();
  const hal::Instant imagined = cabinet.clock().now();
  while (stop == 0) {
    cabinet.step();
    watch.ticked();
    watch.stepped();
    if (speed > 0) {
      const double elapsed_s = hal::seconds(cabinet.clock().now() - imagined);
      clock.wait_until(real + hal::Duration(std::llround(1e9 * elapsed_s / speed)));
    }
  }
}

// The operators' consoles, each behind one that answers `emulate`.
class Emulations {
 public:
  explicit Emulations(std::span<hal::Console* const> inner) {
    for (hal::Console* console : inner) {
      emulations_.push_back(cabinet::EmulationConsole(*console));
      consoles_.push_back(&*emulations_.back());
    }
  }
  Emulations(const Emulations&) = delete;
  Emulations& operator=(const Emulations&) = delete;

  [[nodiscard]] std::span<hal::Console* const> consoles() const {
    return {consoles_.data(), consoles_.size()};
  }
  void attend(cabinet::VirtualCabinet& cabinet) {
    for (auto& emulation : emulations_) emulation->attend(cabinet);
  }

 private:
  FixedVector<std::optional<cabinet::EmulationConsole>, controller::kMaxConsoles> emulations_;
  FixedVector<hal::Console*, controller::kMaxConsoles> consoles_;
};

}  // namespace

int run_virtual(const DaemonConfiguration& configuration, const VirtualOptions& options,
                const volatile std::sig_atomic_t& stop) {
  auto places = open_places(configuration);
  if (!places) return 1;
  Attendance attendance(configuration, *places->console, places->reporting.get());
  linux_hal::SteadyClock clock;
  Emulations emulations(attendance.consoles());
  const auto refinement = std::make_unique<SelfCalibrating>(configuration);
  CheckFile checks(configuration.store);
  const auto cabinet = std::make_unique<cabinet::VirtualCabinet>(
      configuration.controller, configuration.drives,
      world_of(configuration, options, places->store), places->store, emulations.consoles(),
      options.real_time ? &clock : nullptr, &refinement->refinement(), &checks);
  // The threads of a real time would change the world at once.
  if (!options.real_time) emulations.attend(*cabinet);
  attendance.begin(cabinet->controller());
  const auto started = [&] {
    attendance.started(fmt::format("{}: virtual controller, console at {}", configuration.name,
                                   configuration.console));
  };
  bool served = true;
  if (options.real_time) {
    const RealTimeLoop loop{.controller = cabinet->controller(),
                            .clock = cabinet->clock(),
                            .period = configuration.controller.period,
                            .priority = configuration.priority,
                            .watch = attendance.watch(),
                            .journal = attendance.journal()};
    served = run_in_real_time(loop, started, [] {}, stop);
  } else {
    started();
    pace(*cabinet, clock, attendance.watch(), options.speed, stop);
  }
  attendance.end(stop, true);  // the emulated arm goes with the process
  return served ? 0 : 1;
}

}  // namespace armsig::daemon
