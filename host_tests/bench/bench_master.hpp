// SPDX-License-Identifier: MIT
// The master of the emulated arm's drives in real time, tick by tick, as a controller calls it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "hal/canopen/master.hpp"
#include "hal/canopen/range_sensor.hpp"
#include "hal/linux/socket_can.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::bench {

// A system call of User-Mode Linux takes its time: ticks are longer and time-outs wider than in a
// cabinet.
inline canopen::Configuration patient_drives() {
  using std::chrono::milliseconds;
  canopen::Configuration configuration = test::puma_drives();
  configuration.period = milliseconds(10);
  configuration.missed_feedback_limit = 100;
  configuration.heartbeat = milliseconds(200);
  configuration.heartbeat_timeout = milliseconds(2000);
  configuration.sdo_timeout = milliseconds(1000);
  configuration.boot_timeout = milliseconds(10'000);
  configuration.transition_timeout = milliseconds(5000);
  for (auto& axis : configuration.axes) axis.largest_speed = 10;
  return configuration;
}

class BenchMaster {
 public:
  explicit BenchMaster(const canopen::Configuration& configuration = patient_drives(),
                       canopen::FrameSink* others = nullptr)
      : period_(configuration.period),
        bus({.interface_name = "vcan0", .filters = {}}),
        second_bus({.interface_name = "vcan1", .filters = {}}),
        master(*canopen::check(configuration), buses_of(configuration), others),
        targets(configuration.axes.size()),
        next_(clock_.now()) {}

  void tick() {
    (void)bus.status();
    read = master.read(clock_.now());
    if (!following) targets = master.positions();
    written = master.write(targets, clock_.now());
    // A tick that is missed is left out, not made up for.
    next_ = std::max(next_ + period_, clock_.now());
    clock_.wait_until(next_);
  }
  bool run_until(const std::function<bool()>& condition,
                 hal::Duration longest = std::chrono::seconds(150)) {
    const hal::Instant end = clock_.now() + longest;
    while (!condition() && clock_.now() < end) tick();
    return condition();
  }
  // Every drive comes to `condition`, unless one faults first.
  testing::AssertionResult become(hal::DriveCondition condition) {
    run_until([&] { return master.all(condition) || faulted(); });
    if (master.all(condition)) return testing::AssertionSuccess();
    return testing::AssertionFailure() << conditions();
  }
  void run(unsigned ticks) {
    for (unsigned i = 0; i < ticks; ++i) tick();
  }
  // Ticks while a shell runs `command`, which takes longer than drives wait for a SYNC.
  testing::AssertionResult run_beside(const std::string& command) {
    std::atomic<bool> ended{false};
    int status = 0;
    std::thread shell([&] {
      status = std::system(command.c_str());
      ended = true;
    });
    run_until([&] { return ended.load(); });
    shell.join();
    if (status == 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "exit status " << status << " of: " << command;
  }

  // From power-up to every drive enabled and holding.
  testing::AssertionResult enable() {
    following = false;
    const auto disabled = become(hal::DriveCondition::kDisabled);
    if (!disabled) return disabled;
    if (!master.enable()) return testing::AssertionFailure() << "no enable: " << conditions();
    const auto enabled = become(hal::DriveCondition::kEnabled);
    following = static_cast<bool>(enabled);
    return enabled;
  }
  // The same from whatever a fault left, once everything that it sets off has come.
  testing::AssertionResult recover() {
    run(20);
    for (int i = 0; i < 2; ++i) {
      following = false;
      master.reset_faults();
      const auto enabled = enable();
      if (enabled) return enabled;
      std::printf("once more: %s\n", enabled.message());
    }
    master.reset_faults();
    return enable();
  }
  [[nodiscard]] bool faulted() const {
    for (std::size_t i = 0; i < master.count(); ++i) {
      if (master.status(i).fault) return true;
    }
    return false;
  }
  [[nodiscard]] std::string conditions() const {
    std::string text;
    for (std::size_t i = 0; i < master.count(); ++i) {
      const hal::DriveStatus status = master.status(i);
      text += " joint " + std::to_string(i + 1) + ": condition " +
              std::to_string(static_cast<int>(status.condition));
      if (status.fault) text += " (" + std::string(describe(*status.fault)) + ")";
    }
    return text;
  }
  // Joint targets in a minimum-jerk move that takes `ticks`.
  void move(const JointVector& goal, unsigned ticks) {
    const JointVector start = targets;
    for (unsigned k = 1; k <= ticks; ++k) {
      const double s = static_cast<double>(k) / ticks;
      const double way = s * s * s * (10 + s * (6 * s - 15));
      for (std::size_t i = 0; i < goal.size(); ++i) {
        targets[i] = start[i] + way * (goal[i] - start[i]);
      }
      tick();
    }
  }
  [[nodiscard]] hal::Instant now() { return clock_.now(); }

 private:
  canopen::NamedBuses buses_of(const canopen::Configuration& configuration) {
    canopen::NamedBuses buses{{&bus, "vcan0"}};
    if (configuration.buses.count > 1) buses.push_back({&second_bus, "vcan1"});
    return buses;
  }

  hal::Duration period_;
  linux_hal::SteadyClock clock_;

 public:
  linux_hal::SocketCan bus;
  linux_hal::SocketCan second_bus;  // where the configuration has two
  canopen::Master master;
  JointVector targets;
  bool following = false;  // targets are kept instead of following the positions
  Result<void> read;
  Result<void> written;

 private:
  hal::Instant next_;
};

}  // namespace armsig::bench
