// SPDX-License-Identifier: MIT
// Everything a drive or the bus can do to an enabled master, frame by frame: each ends in a quick
// stop in the same tick and a fault with a name.
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/master_script.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using std::chrono::milliseconds;
using test::MasterScript;

struct EnabledMaster : MasterScript {
  explicit EnabledMaster(const Configuration& configuration = test::puma_drives(1))
      : MasterScript(configuration) {
    start();
    EXPECT_TRUE(master->enable());
    cycle("181#5002E8030000", "201#0600E8030000");
    cycle("181#3102E8030000", "201#0700E8030000");
    cycle("181#3302E8030000", "201#0F00E8030000");
    cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(master->status(0).condition, DriveCondition::kEnabled);
  }
  void expect_stopped_by(Error error) {
    EXPECT_EQ(master->status(0).condition, DriveCondition::kFaulted);
    EXPECT_EQ(master->status(0).fault, error);
    bus.expect_all_consumed();
  }
};

TEST(MasterFaults, an_emergency_stops_and_keeps_its_code) {
  EnabledMaster script;
  script.bus.bring("081#1086210000000000");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  EXPECT_EQ(script.master->status(0).fault_code, 0x8610U);
  script.expect_stopped_by(Error::kDriveEmergency);
}

TEST(MasterFaults, an_emergency_keeps_its_error_register_and_the_bytes_of_the_maker) {
  EnabledMaster script;
  script.bus.bring("081#1086210102030405");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  const hal::DeviceDetails first{.error_register = 0x21, .own = {1, 2, 3, 4, 5}};
  EXPECT_EQ(script.master->status(0).fault_details, first);
  // What follows is not the reason.
  script.bus.bring("081#2023010900000000");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  EXPECT_EQ(script.master->status(0).fault_details, first);
  script.expect_stopped_by(Error::kDriveEmergency);
}

TEST(MasterFaults, the_details_of_an_emergency_go_with_the_fault) {
  EnabledMaster script;
  script.bus.bring("081#1086210102030405");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.master->reset_faults();
  EXPECT_EQ(script.master->status(0).fault_details, hal::DeviceDetails());
}

TEST(MasterCounters, count_emergencies_but_not_that_there_is_no_error) {
  EnabledMaster script;
  script.bus.bring("081#0000000000000000");
  script.bus.bring("081#01FF000000000000");
  script.bus.bring("081#1086210000000000");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  EXPECT_EQ(script.master->counters().emergencies, 2U);
}

TEST(MasterCounters, count_a_sync_that_a_drive_leaves_unanswered) {
  EnabledMaster script;
  EXPECT_EQ(script.master->counters().unanswered, 0U);
  script.bus.expect("080#");
  script.bus.expect("201#0F00E8030000");
  script.tick();
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  EXPECT_EQ(script.master->counters().unanswered, 1U);
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  script.bus.expect_all_consumed();
}

TEST(MasterFaults, the_emergency_no_error_stops_nothing) {
  EnabledMaster script;
  script.bus.bring("081#0000000000000000");
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
}

// No bit of the error register is set, or the drive has come back from bus-off.
TEST(MasterFaults, an_emergency_that_tells_no_error_is_kept_and_stops_nothing) {
  for (const auto& [frame, code] :
       {std::pair{"081#01FF000000000000", 0xFF01U}, std::pair{"081#4081110000000000", 0x8140U}}) {
    EnabledMaster script;
    script.bus.bring(frame);
    script.cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
    EXPECT_EQ(script.master->status(0).information, code);
    EXPECT_EQ(script.master->status(0).fault_details, hal::DeviceDetails());
  }
}

// On the wire TPDO1 goes before a heartbeat that the drive had queued before it was started.
TEST(MasterFaults, a_heartbeat_that_the_first_position_overtook_stops_nothing_once) {
  MasterScript script;
  script.start();
  script.bus.bring("701#7F");
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  script.bus.bring("701#7F");
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveNotOperational);
}

// Some buses stamp by a clock that people set.
TEST(MasterFaults, stamps_that_step_by_an_hour_stop_nothing) {
  for (const auto step : {std::chrono::hours(1), std::chrono::hours(-1)}) {
    EnabledMaster script;
    script.bus.stamp_error = step;
    for (int i = 0; i < 20; ++i) script.cycle("181#3712E8030000", "201#0F00E8030000");
    script.master->quick_stop();
    script.cycle("181#3712E8030000", "201#0200E8030000");
    script.cycle("181#1702E8030000", "201#0200E8030000");
    script.bus.stamp_error = {};
    script.cycle("181#1702E8030000", "201#0200E8030000");
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kStopped);
  }
}

TEST(MasterFaults, what_a_drive_says_of_itself_stops_when_it_lasts) {
  Configuration configuration = test::puma_drives(1);
  configuration.status_limits = {.ignores = milliseconds(10),
                                 .limits = milliseconds(11),
                                 .lags = milliseconds(12),
                                 .warns = milliseconds(13),
                                 .no_voltage = milliseconds(14)};
  struct Told {
    const char* feedback;
    Error error;
    int ticks;
  };
  for (const Told& told : {Told{"181#3702E8030000", Error::kTargetsIgnored, 10},
                           Told{"181#371AE8030000", Error::kDriveLimited, 11},
                           Told{"181#3732E8030000", Error::kDriveLags, 12},
                           Told{"181#B712E8030000", Error::kDriveWarning, 13},
                           Told{"181#2712E8030000", Error::kVoltageLost, 14}}) {
    EnabledMaster script(configuration);
    for (int i = 0; i < told.ticks; ++i) script.cycle(told.feedback, "201#0F00E8030000");
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
    script.cycle(told.feedback, "201#0200E8030000");
    script.expect_stopped_by(told.error);
  }
}

TEST(MasterFaults, the_fault_state_stops) {
  EnabledMaster script;
  script.cycle("181#1F02E8030000", "201#0000E8030000");
  script.expect_stopped_by(Error::kDriveFault);
}

TEST(MasterFaults, a_drive_that_loses_its_power_stops) {
  EnabledMaster script;
  script.cycle("181#5002E8030000", "201#0000E8030000");
  script.expect_stopped_by(Error::kDriveDroppedOut);
}

TEST(MasterFaults, a_boot_up_message_stops) {
  EnabledMaster script;
  script.bus.bring("701#00");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.expect_stopped_by(Error::kDriveRebooted);
}

TEST(MasterFaults, a_heartbeat_of_another_state_stops) {
  EnabledMaster script;
  script.bus.bring("701#7F");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.expect_stopped_by(Error::kDriveNotOperational);
  EXPECT_EQ(script.master->status(0).fault_code, 0x7FU) << "pre-operational";
}

TEST(MasterFaults, a_heartbeat_lost_stops_although_positions_come) {
  EnabledMaster script;
  for (int t = 4; t < 150; ++t) {
    script.bus.expect("080#", {"181#3712E8030000"});
    if ((t + 1) % 50 == 0) script.bus.expect("77F#05");
    script.bus.expect("201#0F00E8030000");
    script.tick();
  }
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.expect_stopped_by(Error::kHeartbeatLost);
}

// Twice the period of 50 ms is not over at 100 ms after the start.
TEST(MasterCounters, count_a_heartbeat_that_comes_after_more_than_twice_its_period) {
  for (const auto& [at, late] : {std::pair{90, 0U}, std::pair{120, 1U}}) {
    EnabledMaster script;
    for (int t = 4; t < at; ++t) {
      script.bus.expect("080#", {"181#3712E8030000"});
      if ((t + 1) % 50 == 0) script.bus.expect("77F#05");
      script.bus.expect("201#0F00E8030000");
      script.tick();
    }
    script.bus.bring("701#05");
    script.cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(script.master->counters().late_heartbeats, late) << at;
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  }
}

TEST(MasterFaults, two_positions_missing_in_a_row_stop) {
  EnabledMaster script;
  script.bus.expect("080#");
  script.bus.expect("201#0F00E8030000");
  script.tick();
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  script.bus.expect("080#");
  script.bus.expect("201#0200E8030000");
  script.tick();
  script.expect_stopped_by(Error::kFeedbackLost);
}

TEST(MasterFaults, one_position_missing_does_not_stop) {
  EnabledMaster script;
  for (int i = 0; i < 5; ++i) {
    script.bus.expect("080#");
    script.bus.expect("201#0F00E8030000");
    script.tick();
    script.cycle("181#3712E8030000", "201#0F00E8030000");
  }
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
}

TEST(MasterFaults, a_position_that_jumps_stops) {
  EnabledMaster script;
  script.cycle("181#3712E8030001", "201#0200E8030001");
  script.expect_stopped_by(Error::kFeedbackImplausible);
}

TEST(MasterFaults, a_transition_that_does_not_happen_is_a_fault) {
  Configuration configuration = test::puma_drives(1);
  configuration.transition_timeout = milliseconds(10);
  MasterScript script(configuration);
  script.start();
  ASSERT_TRUE(script.master->enable());
  for (int i = 0; i < 10; ++i) script.cycle("181#5002E8030000", "201#0600E8030000");
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).fault, Error::kTransitionTimeout);
  script.bus.expect_all_consumed();
}

TEST(MasterFaults, somebody_elses_controlword_sync_or_nmt_stops) {
  for (const char* foreign : {"201#0F0000000000", "080#", "000#8000", "77F#05"}) {
    EnabledMaster script;
    script.bus.bring(foreign);
    script.cycle("181#3712E8030000", "201#0200E8030000");
    EXPECT_EQ(script.master->counters().foreign, 1U);
    script.expect_stopped_by(Error::kSecondMaster);
  }
}

// A gripper that another program starts or resets.
TEST(MasterFaults, a_command_to_a_node_of_nobody_s_here_stops_nothing) {
  for (const char* foreign : {"000#0128", "000#8128", "000#8228"}) {
    EnabledMaster script;
    script.bus.bring(foreign);
    script.cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
    EXPECT_EQ(script.master->counters().foreign, 0U);
    EXPECT_EQ(script.master->counters().unknown, 1U);
  }
}

TEST(MasterFaults, malformed_and_unknown_frames_change_nothing_and_are_counted) {
  EnabledMaster script;
  for (const char* odd : {"181#3712", "701#", "081#10", "7FF#00", "2A0#0102", "581#00"}) {
    script.bus.bring(odd);
  }
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  EXPECT_EQ(script.master->counters().malformed, 3U);
  EXPECT_EQ(script.master->counters().unknown, 2U);
}

// An emergency, another master's controlword and its reset, but for the kind of the frame.
TEST(MasterFaults, extended_and_remote_frames_change_nothing_and_are_counted) {
  for (const bool remote : {false, true}) {
    EnabledMaster script;
    for (const char* text : {"081#1086210000000000", "201#0600E8030000", "000#8201"}) {
      hal::CanFrame frame = test::frame(text);
      frame.extended = !remote;
      frame.remote = remote;
      script.bus.bring(frame);
    }
    script.cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
    EXPECT_EQ(script.master->counters().unknown, 3U);
    EXPECT_EQ(script.master->counters().foreign, 0U);
  }
}

TEST(MasterFaults, a_flood_is_taken_in_portions) {
  EnabledMaster script;
  for (unsigned i = 0; i < 2 * Master::kMaxFramesPerTick; ++i) script.bus.bring("7FF#00");
  script.bus.expect("080#");
  script.bus.expect("201#0F00E8030000");
  script.tick();
  EXPECT_EQ(script.master->counters().unknown, Master::kMaxFramesPerTick);
}

TEST(MasterFaults, bus_off_is_told_and_stops_when_the_bus_is_back) {
  EnabledMaster script;
  script.bus.set_state(hal::CanState::kBusOff);
  script.tick();
  EXPECT_EQ(test::failure_of(script.read), Error::kBusOff);
  EXPECT_EQ(test::failure_of(script.written), Error::kBusOff);
  script.bus.set_state(hal::CanState::kActive);
  script.cycle("181#3712E8030000", "201#0200E8030000");
  EXPECT_TRUE(script.read);
  script.expect_stopped_by(Error::kBusOff);
}

TEST(MasterFaults, a_bus_that_is_down_is_told) {
  EnabledMaster script;
  script.bus.set_state(hal::CanState::kDown);
  script.tick();
  EXPECT_EQ(test::failure_of(script.read), Error::kBusDown);
  script.expect_stopped_by(Error::kBusDown);
}

TEST(MasterFaults, a_bus_that_takes_nothing_for_three_ticks_is_a_fault) {
  EnabledMaster script;
  script.bus.set_full(true);
  for (int i = 0; i < 2; ++i) {
    script.bus.bring("181#3712E8030000");
    script.tick();
    EXPECT_EQ(test::failure_of(script.written), Error::kBusBusy);
    EXPECT_EQ(script.master->status(0).condition, DriveCondition::kEnabled);
  }
  script.bus.bring("181#3712E8030000");
  script.tick();
  script.expect_stopped_by(Error::kBusBusy);
}

TEST(MasterFaults, a_refused_target_is_told_before_a_bus_that_takes_nothing) {
  EnabledMaster script;
  script.keep_targets = true;
  script.targets[0] = std::nan("");
  script.bus.set_full(true);
  script.bus.bring("181#3712E8030000");
  script.tick();
  EXPECT_EQ(test::failure_of(script.written), Error::kNotFinite);
}

TEST(MasterFaults, a_target_out_of_limits_or_too_fast_or_not_a_number_is_not_sent) {
  EnabledMaster script;
  script.keep_targets = true;
  const double here = script.master->positions()[0];
  for (const auto& [target, error] :
       {std::pair{4.0, Error::kJointLimit}, std::pair{here + 0.1, Error::kTargetStep},
        std::pair{std::nan(""), Error::kNotFinite}}) {
    script.targets[0] = target;
    script.cycle("181#3712E8030000", "201#0F00E8030000");
    EXPECT_EQ(test::failure_of(script.written), error);
  }
  script.targets[0] = here;
  script.cycle("181#3712E8030000", "201#0F00E8030000");
  EXPECT_TRUE(script.written);
}

TEST(MasterFaults, a_fault_keeps_its_first_cause) {
  EnabledMaster script;
  script.bus.bring("081#1086210000000000");
  script.bus.bring("701#00");
  script.cycle("181#1F02E8030000", "201#0000E8030000");
  script.expect_stopped_by(Error::kDriveEmergency);
}

TEST(MasterFaults, enabling_is_refused_until_the_fault_is_reset) {
  EnabledMaster script;
  script.bus.bring("081#1086210000000000");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  EXPECT_EQ(test::failure_of(script.master->enable()), Error::kDrivesNotReady);
  script.master->reset_faults();
  script.cycle("181#1702E8030000", "201#0000E8030000");
  script.cycle("181#5002E8030000", "201#0000E8030000");
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  EXPECT_TRUE(script.master->enable());
  script.bus.expect_all_consumed();
}

TEST(MasterFaults, a_lost_drive_is_reset_and_set_up_again) {
  EnabledMaster script;
  script.bus.bring("701#00");
  script.cycle("181#3712E8030000", "201#0200E8030000");
  script.master->reset_faults();
  script.bus.expect("000#8201", {"701#00"});
  script.tick();
  test::script_set_up(script.bus);
  while (script.master->node_state(0).phase != Phase::kStarted) script.tick({});
  script.bus.expect("080#", {"181#5002E8030000"});
  script.bus.expect("201#0000E8030000");
  script.tick({});
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  script.bus.expect_all_consumed();
}

}  // namespace
}  // namespace armsig::canopen
