// SPDX-License-Identifier: MIT
// One arm whose drives are on two buses, in virtual time: six joints at 1 kHz, with the nodes 1 to
// 3 on each bus.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using cia402::State;
using hal::DriveCondition;
using simulated::DriveFault;
using test::EmulatedArm;
using test::puma_on_two_buses;

struct FrameLog final : simulated::CanWatcher {
  std::vector<hal::ReceivedCanFrame> frames;
  [[nodiscard]] std::vector<hal::Instant> times_of(std::uint32_t id) const {
    std::vector<hal::Instant> times;
    for (const auto& received : frames) {
      if (received.frame.id == id) times.push_back(received.at);
    }
    return times;
  }

 private:
  void do_see(const hal::ReceivedCanFrame& received) override { frames.push_back(received); }
};

struct TwoBuses : EmulatedArm {
  explicit TwoBuses(const Configuration& configuration = puma_on_two_buses())
      : EmulatedArm(configuration) {
    bus.set_watcher(&first);
    second_bus.set_watcher(&second);
  }
  bool recover() {
    following = false;
    master->reset_faults();
    return run_until(DriveCondition::kDisabled, 6000) && power_up_and_enable();
  }

  FrameLog first;
  FrameLog second;
};

struct MovingOnTwo : TwoBuses {
  MovingOnTwo() {
    EXPECT_TRUE(power_up_and_enable());
    for (int i = 0; i < 100; ++i) {
      tick([&] {
        for (double& target : targets) target += 0.0005;
      });
    }
  }
  // The joints of the failed bus name it, and those of the other one stand under torque.
  void expect_stopped(Error error, std::size_t failed) {
    EXPECT_EQ(test::failure_of(read), error);
    for (std::size_t joint = 0; joint < 6; ++joint) {
      const hal::DriveStatus status = master->status(joint);
      if (joint / 3 == failed) {
        EXPECT_EQ(status.fault, error) << joint;
        EXPECT_EQ(status.words, failed == 0 ? "one" : "two") << joint;
        EXPECT_NE(drives[joint].state(), State::kOperationEnabled) << joint;
      } else {
        EXPECT_FALSE(status.fault) << joint;
        EXPECT_EQ(drives[joint].state(), State::kQuickStopActive) << joint;
        EXPECT_LT(std::fabs(drives[joint].velocity()), 1) << joint;
      }
    }
  }
};

TEST(TwoBuses, carry_six_joints_at_1_kHz_which_one_bus_cannot) {
  const auto checked = check(puma_on_two_buses());
  ASSERT_TRUE(checked);
  EXPECT_NEAR(checked->bus_load(0), 745.0 / 1000 + 4 * 65.0 / 50000, 1e-12);
  EXPECT_EQ(checked->bus_load(1), checked->bus_load(0));
  Configuration one = test::puma_drives();
  one.period = std::chrono::milliseconds(1);
  ASSERT_FALSE(check(one));
  EXPECT_EQ(test::failure_of(check(one)).error, Error::kBusOverload);
}

TEST(TwoBuses, set_up_enable_and_move_joints_whose_nodes_have_the_same_numbers) {
  MovingOnTwo arm;
  arm.run(50);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_EQ(arm.drives[joint].state(), State::kOperationEnabled) << joint;
    EXPECT_NEAR(arm.master->positions()[joint], arm.targets[joint], 1e-4) << joint;
    EXPECT_TRUE(arm.master->identity(joint)) << joint;
  }
  for (const std::uint8_t bus : {std::uint8_t{0}, std::uint8_t{1}}) {
    EXPECT_EQ(arm.master->counters(bus).unknown, 0U);
    EXPECT_EQ(arm.master->counters(bus).malformed, 0U);
    EXPECT_EQ(arm.master->counters(bus).unsent, 0U);
  }
}

TEST(TwoBuses, have_a_SYNC_in_every_cycle_and_a_heartbeat_each) {
  TwoBuses arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.first.frames.clear();
  arm.second.frames.clear();
  arm.run(200);
  const auto syncs = arm.first.times_of(kSyncId);
  EXPECT_EQ(syncs.size(), 200U);
  EXPECT_EQ(arm.second.times_of(kSyncId), syncs) << "at the same moments";
  for (const FrameLog* log : {&arm.first, &arm.second}) {
    EXPECT_EQ(log->times_of(kHeartbeatId + kLargestNode).size(), 4U);
    EXPECT_EQ(log->times_of(kReceivePdo1Id + 1).size(), 200U);
    EXPECT_EQ(log->times_of(kTransmitPdo1Id + 1).size(), 200U);
  }
}

TEST(TwoBuses, are_not_waited_for_one_after_the_other) {
  TwoBuses arm;
  ASSERT_TRUE(arm.power_up_and_enable());
  const hal::Instant before = arm.clock.now();
  (void)arm.master->read(before);
  (void)arm.master->write(arm.targets, before);
  EXPECT_EQ(arm.clock.now(), before);
}

TEST(TwoBuses, have_an_interface_taken_down_stop_every_joint_and_come_back) {
  for (const std::size_t failed : {0U, 1U}) {
    MovingOnTwo arm;
    simulated::VirtualCanPort& port = failed == 0 ? arm.master_port : arm.second_port;
    port.set_up(false);
    arm.run(200);
    arm.expect_stopped(Error::kBusDown, failed);
    port.set_up(true);
    arm.run(10);
    EXPECT_TRUE(arm.read);
    EXPECT_TRUE(arm.recover());
  }
}

TEST(TwoBuses, name_an_interface_that_fails_between_reading_and_writing) {
  for (const bool off : {false, true}) {
    MovingOnTwo arm;
    arm.tick([&] {
      if (off) arm.second_port.go_bus_off();
      if (!off) arm.second_port.set_up(false);
    });
    const Error error = off ? Error::kBusOff : Error::kBusDown;
    EXPECT_TRUE(arm.read);
    EXPECT_EQ(test::failure_of(arm.written), error);
    for (std::size_t joint = 0; joint < 6; ++joint) {
      const hal::DriveStatus status = arm.master->status(joint);
      EXPECT_EQ(status.fault, joint < 3 ? std::nullopt : std::optional(error)) << joint;
      EXPECT_EQ(status.words, joint < 3 ? "" : "two") << joint;
    }
  }
}

TEST(TwoBuses, have_a_bus_off_stop_every_joint_and_come_back) {
  for (const std::size_t failed : {0U, 1U}) {
    MovingOnTwo arm;
    (failed == 0 ? arm.master_port : arm.second_port).go_bus_off();
    arm.run(80);
    arm.expect_stopped(Error::kBusOff, failed);
    arm.run(100);
    EXPECT_TRUE(arm.read) << "it came back by itself";
    EXPECT_EQ(arm.master->status(failed * 3).fault, Error::kBusOff) << "until a reset";
    EXPECT_TRUE(arm.recover());
  }
}

TEST(TwoBuses, tell_an_emergency_of_a_node_from_that_of_its_namesake) {
  MovingOnTwo arm;
  arm.drives[3].inject(DriveFault::kEmergency, 0x2310);
  arm.run(50);
  EXPECT_EQ(arm.master->status(3).fault, Error::kDriveEmergency);
  EXPECT_FALSE(arm.master->status(0).fault);
  EXPECT_EQ(arm.drives[0].state(), State::kQuickStopActive);
  arm.drives[3].inject(DriveFault::kNone);
  EXPECT_TRUE(arm.recover());
}

TEST(TwoBuses, have_a_silent_drive_of_one_stop_the_joints_of_both) {
  MovingOnTwo arm;
  arm.drives[4].inject(DriveFault::kSilent);
  arm.run(50);
  EXPECT_EQ(arm.master->status(4).fault, Error::kFeedbackLost);
  for (const std::size_t joint : {0U, 1U, 2U, 3U, 5U}) {
    EXPECT_EQ(arm.drives[joint].state(), State::kQuickStopActive) << joint;
  }
}

// What was not asked whether it stands is not reset, and takes its torque from no other.
TEST(TwoBuses, begin_when_both_are_there) {
  TwoBuses arm;
  arm.second_port.set_up(false);
  arm.run(5000);
  EXPECT_EQ(test::failure_of(arm.read), Error::kBusDown);
  EXPECT_TRUE(arm.first.times_of(kNmtId).empty());
  EXPECT_EQ(arm.master->status(3).words, "two");
  EXPECT_TRUE(arm.master->status(0).words.empty());
  arm.second_port.set_up(true);
  EXPECT_TRUE(arm.power_up_and_enable());
}

TEST(TwoBuses, have_another_master_on_either_stop_every_joint) {
  MovingOnTwo arm;
  simulated::VirtualCanPort stranger;
  arm.second_bus.connect(stranger);
  ASSERT_TRUE(stranger.send(sync_frame()));
  arm.run(3);
  EXPECT_EQ(arm.master->counters(0).foreign, 0U);
  EXPECT_EQ(arm.master->counters(1).foreign, 1U);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_EQ(arm.master->status(joint).fault, Error::kSecondMaster) << joint;
    EXPECT_EQ(arm.master->status(joint).words, "two") << joint;
  }
  simulated::VirtualCanPort another;
  arm.bus.connect(another);
  ASSERT_TRUE(another.send(sync_frame()));
  arm.run(3);
  EXPECT_EQ(arm.master->counters(0).foreign, 1U);
  EXPECT_EQ(arm.master->status(0).words, "two") << "the first is told";
}

TEST(TwoBuses, have_other_devices_each_which_are_started_on_their_own) {
  Configuration configuration = puma_on_two_buses();
  configuration.others[1].nodes.push_back(40);
  TwoBuses arm(configuration);
  arm.run(5);
  const auto starts = [](const FrameLog& log) {
    return std::ranges::count_if(log.frames, [](const hal::ReceivedCanFrame& received) {
      return received.frame.id == kNmtId && received.frame.data[0] == 1 &&
             received.frame.data[1] == 40;
    });
  };
  EXPECT_EQ(starts(arm.first), 0);
  EXPECT_EQ(starts(arm.second), 1);
}

TEST(TwoBuses, are_refused_where_there_are_not_so_many) {
  Configuration configuration = puma_on_two_buses();
  configuration.axes[4].bus = 2;
  ASSERT_FALSE(check(configuration));
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kUnsupported);
  EXPECT_EQ(test::failure_of(check(configuration)).axis, 4U);
  for (const std::uint8_t count : {std::uint8_t{0}, std::uint8_t{3}}) {
    configuration = puma_on_two_buses();
    configuration.buses.count = count;
    ASSERT_FALSE(check(configuration));
    EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kUnsupported);
  }
  configuration = puma_on_two_buses();
  configuration.buses.sink = 2;
  EXPECT_FALSE(check(configuration));
}

TEST(TwoBuses, are_refused_with_a_node_twice_on_one_of_them) {
  Configuration configuration = puma_on_two_buses();
  configuration.axes[5].node = 1;
  ASSERT_FALSE(check(configuration));
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kNodeTwice);
  EXPECT_EQ(test::failure_of(check(configuration)).axis, 5U);
  configuration = puma_on_two_buses();
  configuration.others[0].nodes.push_back(2);
  EXPECT_FALSE(check(configuration));
  configuration.others[0].nodes.clear();
  configuration.others[0].nodes.push_back(40);
  configuration.others[1].nodes.push_back(40);
  EXPECT_TRUE(check(configuration));
}

TEST(TwoBuses, are_refused_where_one_of_them_is_overloaded) {
  Configuration configuration = puma_on_two_buses();
  configuration.others[1].traffic.push_back({8, std::chrono::milliseconds(1)});
  ASSERT_FALSE(check(configuration));
  EXPECT_EQ(test::failure_of(check(configuration)).error, Error::kBusOverload);
  EXPECT_GT(periodic_load(configuration, 1), kLargestBusLoad);
}

}  // namespace
}  // namespace armsig::canopen
