// SPDX-License-Identifier: MIT
// What the servo tick's own work costs: kinematics, supervision and the CANopen stack, in processor
// time, without what a kernel adds for each frame.
#include <time.h>

#include <deque>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

class NoSensor final : public hal::RangeSensor {
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant /*now*/) override {
    return std::nullopt;
  }
};

hal::Duration processor_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
}

// The Puma's controller tick by tick, its drives on a virtual bus.
struct Rig {
  Rig() {
    bus.connect(master_port);
    const canopen::Configuration drives = test::puma_bus();
    for (const canopen::AxisConfiguration& axis : drives.axes) {
      ports.emplace_back();
      motors.emplace_back(simulated::DriveConfiguration{.node = axis.node}, ports.back());
      bus.connect(ports.back(), &motors.back());
    }
    clock.add(bus);
    master.emplace(*canopen::check(drives), master_port);
    Configuration configuration = test::puma_controller();
    configuration.sweeps.configuration = JointVector(6);
    controller =
        std::make_unique<Controller>(configuration, *master, sensor, clock, memory, consoles);
  }
  void step() {
    const hal::Duration lateness = clock.wait_until(next);
    const hal::Duration before = processor_time();
    controller->tick(lateness);
    const hal::Duration after = processor_time();
    if (measuring) work.add(after - before);
    controller->background();
    next += std::chrono::milliseconds(2);
  }
  bool run_until(Mode mode) {
    for (int i = 0; i < 5000 && controller->state().snapshot().mode != mode; ++i) step();
    return controller->state().snapshot().mode == mode;
  }

  simulated::VirtualClock clock;
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort master_port;
  std::deque<simulated::VirtualCanPort> ports;
  std::deque<simulated::Drive> motors;
  std::optional<canopen::Master> master;
  NoSensor sensor;
  test::RamMemory memory;
  test::LineConsole console;
  std::array<hal::Console*, 1> consoles{&console};
  std::unique_ptr<Controller> controller;
  hal::Instant next;
  bool measuring = false;
  Histogram work;
};

TEST(ServoTime, of_a_line_of_the_tool_is_under_5_percent_of_the_period) {
  Rig rig;
  ASSERT_TRUE(rig.run_until(Mode::kIdle));
  rig.console.requests.emplace_back("enable");
  ASSERT_TRUE(rig.run_until(Mode::kHolding));
  rig.console.requests.emplace_back("move q2_deg=-90 q3_deg=10 q4_deg=30 q5_deg=40");
  ASSERT_TRUE(rig.run_until(Mode::kServoing));
  ASSERT_TRUE(rig.run_until(Mode::kHolding));
  rig.console.requests.emplace_back("move dz_mm=-100 dx_mm=50 pace=0.2");
  ASSERT_TRUE(rig.run_until(Mode::kServoing)) << rig.console.replies.back();
  rig.measuring = true;
  ASSERT_TRUE(rig.run_until(Mode::kHolding));
  ASSERT_GT(rig.work.total, 300U);
  std::printf("%.1f us a tick, at most %.1f us, over %u ticks at 2000 us\n", rig.work.mean_us(),
              1e6 * hal::seconds(rig.work.largest), static_cast<unsigned>(rig.work.total));
#ifdef NDEBUG
  EXPECT_LT(rig.work.mean_us(), 0.05 * 2000);
#endif
}

}  // namespace
}  // namespace armsig::controller
