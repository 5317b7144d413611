// SPDX-License-Identifier: MIT
// A master and emulated drives on a virtual bus, in virtual time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>

#include "hal/canopen/master.hpp"
#include "hal/simulated/drive.hpp"
#include "hal/simulated/virtual_can_bus.hpp"
#include "hal/simulated/virtual_clock.hpp"

namespace armsig::test {

struct EmulatedArm {
  // Ideal drives, or `drive` for each.
  explicit EmulatedArm(const canopen::Configuration& configuration,
                       canopen::FrameSink* other_frames = nullptr,
                       simulated::DriveConfiguration drive = {})
      : period(configuration.period) {
    bus.connect(master_port);
    second_bus.connect(second_port);
    for (const canopen::AxisConfiguration& axis : configuration.axes) {
      ports.emplace_back();
      drive.node = axis.node;
      drive.axis = {.number = axis.axis, .emulated = axes_of(configuration, axis)};
      drives.emplace_back(drive, ports.back());
      (axis.bus == 0 ? bus : second_bus).connect(ports.back(), &drives.back());
    }
    clock.add(bus);
    clock.add(second_bus);
    canopen::NamedBuses buses{{&master_port, "one"}};
    if (configuration.buses.count > 1) buses.push_back({&second_port, "two"});
    master.emplace(*canopen::check(configuration), buses, other_frames);
    targets.resize(configuration.axes.size());
  }

  // Those of a node that are joints, a bit each.
  static std::uint8_t axes_of(const canopen::Configuration& configuration,
                              const canopen::AxisConfiguration& of_node) {
    unsigned axes = 0;
    for (const canopen::AxisConfiguration& axis : configuration.axes) {
      if (axis.shares_node(of_node)) axes |= 1U << (axis.axis - 1U);
    }
    return static_cast<std::uint8_t>(axes);
  }
  // One tick; `plan` may change the targets between reading and writing.
  void tick(const std::function<void()>& plan = {}) {
    read = master->read(clock.now());
    if (!following) targets = master->positions();
    if (plan) plan();
    written = master->write(targets, clock.now());
    ++ticks;
    clock.wait_until(hal::Instant(period * ticks));
  }
  void run(unsigned count) {
    for (unsigned i = 0; i < count; ++i) tick();
  }
  // Ticks until every drive has the condition; false after `most` ticks.
  bool run_until(hal::DriveCondition condition, unsigned most = 2000) {
    for (unsigned i = 0; i < most; ++i) {
      if (master->all(condition)) return true;
      tick();
    }
    return master->all(condition);
  }
  // From power-up to every drive enabled and holding.
  bool power_up_and_enable() {
    using enum hal::DriveCondition;
    if (!run_until(kDisabled) || !master->enable() || !run_until(kEnabled)) return false;
    following = true;
    return true;
  }

  hal::Duration period;
  simulated::VirtualClock clock;
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort master_port;
  simulated::VirtualCanBus second_bus;  // where the configuration has two
  simulated::VirtualCanPort second_port;
  std::deque<simulated::VirtualCanPort> ports;
  std::deque<simulated::Drive> drives;
  std::optional<canopen::Master> master;
  JointVector targets;
  bool following = false;  // targets are kept instead of following the positions
  int ticks = 0;
  Result<void> read;
  Result<void> written;
};

}  // namespace armsig::test
