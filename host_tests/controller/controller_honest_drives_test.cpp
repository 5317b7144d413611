// SPDX-License-Identifier: MIT
// The whole controller over drives as they are: 180 deg/s^2 on their ramps, gravity, coasting,
// brakes that take their time, statuswords that tell what is wrong.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/base/error_name.hpp"
#include "firmware/linux/shut_down.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

using cia402::State;
using simulated::DriveFault;
using test::PumaCabinet;

struct Honest : PumaCabinet {
  explicit Honest(const Configuration& configuration = test::puma_controller(),
                  const simulated::DriveConfiguration& drive = test::honest_puma_drive())
      : PumaCabinet(1, configuration, drive) {}
  // rad/s of a joint.
  [[nodiscard]] double speed(std::size_t joint) {
    return cabinet->drive(joint).velocity() / test::kPumaCountsPerRadian;
  }
  // Ticks, and the fastest that a joint was when its torque went.
  double run_watching(double seconds) {
    double released_at = 0;
    for (int i = 0; i < static_cast<int>(seconds / 0.002); ++i) {
      std::array<bool, 6> had{};
      for (std::size_t j = 0; j < 6; ++j) had[j] = cabinet->drive(j).has_torque();
      cabinet->step();
      for (std::size_t j = 0; j < 6; ++j) {
        if (!had[j] || cabinet->drive(j).has_torque()) continue;
        released_at = std::max(released_at, std::abs(speed(j)));
      }
    }
    return released_at;
  }
  bool told(const std::string& words) {
    return std::ranges::any_of(console.told,
                               [&](const std::string& line) { return line.starts_with(words); });
  }
};

struct HonestMoving : Honest {
  HonestMoving() {
    EXPECT_TRUE(enable());
    EXPECT_EQ(ask("move q1_deg=90 q2_deg=-30"), "ok");
    run(1.2);
    EXPECT_GT(std::abs(speed(0)), 0.7);
  }
};

TEST(HonestStop, then_reset_takes_the_torque_off_at_rest) {
  HonestMoving puma;
  ASSERT_EQ(puma.ask("stop"), "ok");
  ASSERT_EQ(puma.ask("reset"), "ok");
  EXPECT_GT(std::abs(puma.speed(0)), 0.5);
  EXPECT_LT(puma.run_watching(2), 1e-3);
  EXPECT_EQ(puma.mode(), Mode::kIdle);
  EXPECT_TRUE(puma.enable());
}

TEST(HonestStop, disable_takes_the_torque_off_at_rest) {
  HonestMoving puma;
  ASSERT_EQ(puma.ask("disable"), "ok");
  EXPECT_LT(puma.run_watching(2), 1e-3);
  EXPECT_FALSE(puma.cabinet->drive(0).has_torque());
}

TEST(HonestStop, a_fault_of_one_takes_the_torque_of_the_others_off_at_rest) {
  HonestMoving puma;
  puma.cabinet->drive(3).inject(DriveFault::kHeartbeatLost);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  puma.cabinet->drive(3).inject(DriveFault::kNone);
  ASSERT_EQ(puma.ask("reset"), "ok");
  EXPECT_LT(puma.run_watching(2.5), 1e-3);
  EXPECT_EQ(puma.mode(), Mode::kIdle);
}

TEST(HonestEnabling, moves_no_joint_while_others_are_enabled) {
  simulated::DriveConfiguration drive = test::honest_puma_drive();
  drive.motion.droop = radians(0.36) * test::kPumaCountsPerRadian;
  Honest puma(test::puma_controller(), drive);
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.cabinet->drive(5).inject(DriveFault::kDeaf);
  const double before = puma.cabinet->drive(0).position();
  ASSERT_EQ(puma.ask("enable"), "ok");
  puma.run(0.9);
  ASSERT_EQ(puma.cabinet->drive(0).state(), State::kOperationEnabled);
  EXPECT_LT(std::abs(puma.cabinet->drive(0).position() - before),
            radians(0.361) * test::kPumaCountsPerRadian);
}

TEST(HonestEnabling, is_supervised_from_the_first_drive_on) {
  Honest puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  puma.cabinet->drive(5).inject(DriveFault::kDeaf);
  ASSERT_EQ(puma.ask("enable"), "ok");
  puma.run(0.2);
  ASSERT_EQ(puma.mode(), Mode::kIdle);
  puma.cabinet->drive(0).inject(DriveFault::kBlocked);
  for (int i = 0; i < 50; ++i) {  // 0.1 rad in 0.1 s
    puma.cabinet->drive(0).push(0.002 * test::kPumaCountsPerRadian);
    puma.cabinet->step();
  }
  ASSERT_EQ(puma.mode(), Mode::kFaulted);
  EXPECT_EQ(puma.now().fault->error, Error::kFollowingError);
  EXPECT_EQ(puma.now().fault->joint, 0U);
}

struct Told {
  DriveFault fault;
  std::uint16_t bit;
  Error error;
  double within_s;
};

TEST(HonestStatus, what_a_drive_says_of_itself_is_a_fault_by_name_in_time) {
  using enum DriveFault;
  for (const Told& told : {Told{kIgnoresTargets, 0, Error::kTargetsIgnored, 0.35},
                           Told{kBitsClear, 1U << 12, Error::kTargetsIgnored, 0.35},
                           Told{kBitsSet, 1U << 11, Error::kDriveLimited, 0.55},
                           Told{kBitsSet, 1U << 13, Error::kDriveLags, 0.15},
                           Told{kBitsSet, 1U << 7, Error::kDriveWarning, 2.05},
                           Told{kBitsClear, 1U << 4, Error::kVoltageLost, 0.15}}) {
    Honest puma;
    ASSERT_TRUE(puma.enable());
    puma.cabinet->drive(2).inject(told.fault, told.bit);
    puma.run(told.within_s - 0.1);
    EXPECT_EQ(puma.mode(), Mode::kHolding) << name(told.error);
    puma.run(0.1);
    ASSERT_EQ(puma.mode(), Mode::kFaulted) << name(told.error);
    EXPECT_EQ(puma.now().fault->error, told.error) << name(puma.now().fault->error);
    EXPECT_EQ(puma.now().fault->joint, 2U);
    puma.cabinet->drive(2).inject(kNone);
    EXPECT_EQ(puma.ask("reset"), "ok");
    EXPECT_TRUE(puma.enable()) << name(told.error);
  }
}

TEST(HonestStatus, a_warning_is_told_from_its_first_moment) {
  Honest puma;
  ASSERT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("status").find(" warning="), std::string::npos);
  puma.cabinet->drive(2).inject(DriveFault::kBitsSet, 1U << 7);
  puma.run(0.1);
  EXPECT_NE(puma.ask("status").find(" warning=3 "), std::string::npos);
}

TEST(HonestStatus, an_emergency_tells_its_error_register_until_it_is_reset) {
  Honest puma;
  ASSERT_TRUE(puma.enable());
  puma.cabinet->drive(2).inject(DriveFault::kEmergency, 0x2310);
  ASSERT_TRUE(puma.run_until(Mode::kFaulted, 1));
  puma.run(0.1);
  EXPECT_NE(puma.ask("status").find(" fault_says=\"continuous over-current\" fault_register=0x21"),
            std::string::npos);
  const auto& told = puma.console.told;
  EXPECT_TRUE(std::ranges::any_of(told, [](const std::string& line) {
    return line.starts_with("# mode faulted error=DRIVE_EMERGENCY ") &&
           line.ends_with(" code=0x2310 says=\"continuous over-current\" register=0x21");
  }));
  puma.cabinet->drive(2).inject(DriveFault::kNone);
  EXPECT_EQ(puma.ask("reset"), "ok");
  EXPECT_TRUE(puma.enable());
  EXPECT_EQ(puma.ask("status").find("register"), std::string::npos);
}

TEST(HonestStatus, an_emergency_that_informs_stops_nothing) {
  Honest puma;
  ASSERT_TRUE(puma.enable());
  puma.cabinet->drive(2).inject(DriveFault::kInformation, 0xFF01);
  puma.run(1);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
}

TEST(Tickets, a_refused_command_is_answered_so_and_ends_no_sequence) {
  Honest puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  for (int i = 0; i < 200; ++i) {
    EXPECT_TRUE(puma.ask(puma.other, "enable").starts_with("error WRONG_MODE ")) << i;
    puma.run(0.002 * (i % 5));
  }
  EXPECT_TRUE(puma.cabinet->state().identification().is_running());
  EXPECT_EQ(puma.mode(), Mode::kSweeping);
}

TEST(Tickets, a_command_that_the_tick_refuses_is_answered_with_the_mode) {
  Honest puma;
  ASSERT_TRUE(puma.run_until(Mode::kIdle));
  ASSERT_EQ(puma.ask("enable"), "ok");
  EXPECT_EQ(puma.ask("enable"), "error WRONG_MODE the present mode does not allow it mode=idle")
      << "it is under way";
}

TEST(Bounds, an_arm_that_does_not_settle_ends_the_sequence_with_its_joint) {
  Configuration configuration = test::puma_controller();
  configuration.dwell.settle_timeout = std::chrono::seconds(1);
  Honest puma(configuration);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(0.1);
  // Hunts by four tolerances about its target.
  for (int i = 0; i < 10'000 && puma.cabinet->state().identification().is_running(); ++i) {
    puma.cabinet->drive(2).push((i % 2 == 0 ? 4e-4 : -4e-4) * test::kPumaCountsPerRadian);
    puma.run(0.002);
  }
  EXPECT_FALSE(puma.cabinet->state().identification().is_running());
  EXPECT_TRUE(puma.told("# identify ended error=NOT_SETTLED"));
  EXPECT_NE(puma.console.told.back().find(" joint=3"), std::string::npos)
      << puma.console.told.back();
}

TEST(Bounds, readings_that_give_no_point_pause_the_sequence) {
  Configuration configuration = test::puma_controller();
  configuration.sensor.reading_timeout = std::chrono::milliseconds(50);
  Honest puma(configuration);
  ASSERT_TRUE(puma.enable());
  puma.cabinet->sensor().set_stamp_error(-std::chrono::hours(1));
  ASSERT_EQ(puma.ask("identify"), "ok");
  puma.run(10);
  EXPECT_TRUE(puma.told("# identify paused error=POINT_TIMEOUT"));
}

TEST(Bounds, a_tolerance_below_a_count_is_refused) {
  Configuration configuration = test::puma_controller();
  configuration.resolution.resize(6);
  for (double& count : configuration.resolution) count = 1e-5;
  configuration.dwell.tolerance = 1.1e-5;
  EXPECT_TRUE(check(configuration));
  configuration.dwell.tolerance = 0.9e-5;
  ASSERT_FALSE(check(configuration));
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kToleranceTooFine);
}

TEST(Points, are_refused_when_the_arm_moved_between_pings) {
  Honest puma;
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  std::size_t refused = 0;
  for (int i = 0; i < 4000 && refused == 0; ++i) {
    puma.cabinet->step();
    // Every 40 ms, so that no point has its five pings between two pushes; the arm settles between.
    if (puma.now().settled > std::chrono::milliseconds(240)) {
      puma.cabinet->drive(1).push(radians(0.36) * test::kPumaCountsPerRadian);
    }
    refused = static_cast<std::size_t>(std::ranges::count_if(
        puma.console.told,
        [](const std::string& line) { return line.starts_with("# identify point refused"); }));
  }
  EXPECT_EQ(refused, 1U);
  EXPECT_EQ(puma.cabinet->state().identification().points_done(), 0U);
  for (int i = 0; i < 8000 && puma.cabinet->state().identification().is_running(); ++i) {
    puma.cabinet->step();
    if (puma.now().settled > std::chrono::milliseconds(240)) {
      puma.cabinet->drive(1).push(radians(0.36) * test::kPumaCountsPerRadian);
    }
  }
  EXPECT_TRUE(puma.told("# identify ended error=ARM_MOVED"));
}

TEST(HonestShutDown, of_the_process_takes_the_torque_off_at_rest) {
  simulated::VirtualClock clock;
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort master_port;
  simulated::VirtualCanPort port;
  bus.connect(master_port);
  simulated::Drive drive(test::honest_puma_drive(), port);
  bus.connect(port, &drive);
  clock.add(bus);
  canopen::Configuration configuration = test::puma_bus();
  configuration.axes.resize(1);
  canopen::Master master(*canopen::check(configuration), master_port);
  hal::Instant next;
  JointVector targets(1);
  const auto run_until = [&](hal::DriveCondition condition, double rate, int most) {
    for (int i = 0; i < most && !master.all(condition); ++i) {
      (void)master.read(clock.now());
      targets[0] += 0.002 * rate;
      (void)master.write(targets, clock.now());
      clock.wait_until(next += configuration.period);
    }
    return master.all(condition);
  };
  ASSERT_TRUE(run_until(hal::DriveCondition::kDisabled, 0, 1000));
  ASSERT_TRUE(master.enable());
  ASSERT_TRUE(run_until(hal::DriveCondition::kEnabled, 0, 1000));
  (void)run_until(hal::DriveCondition::kFaulted, 1.0, 300);
  ASSERT_GT(drive.velocity() / test::kPumaCountsPerRadian, 0.9);
  const double before = drive.position() / test::kPumaCountsPerRadian;
  EXPECT_TRUE(daemon::shut_down(master, clock, configuration.period));
  EXPECT_FALSE(drive.has_torque());
  EXPECT_EQ(drive.velocity(), 0);
  EXPECT_LT(drive.position() / test::kPumaCountsPerRadian - before, 1.1 / (2 * kPi) + 0.01);
}

}  // namespace
}  // namespace armsig::controller
