// SPDX-License-Identifier: MIT
// What a master says on the bus from its first tick to the first controlword, frame by frame. The
// frames are written by hand from CiA 301 and CiA 402, in the notation of the can-utils.
#include <chrono>

#include <gtest/gtest.h>

#include "hal/canopen/master.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/master_script.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using test::MasterScript;
using test::puma_axis;
using test::script_set_up;

TEST(MasterStartUp, sets_up_one_drive_with_the_standards_frames) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);
  script.tick();
  script.tick({});
  script_set_up(script.bus);
  for (int i = 0; i < 90 && script.master->node_state(0).phase != Phase::kStarted; ++i) {
    script.tick({});
  }
  script.bus.expect_all_consumed();
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kStarting);
}

TEST(MasterStartUp, is_ready_and_disabled_at_the_first_position) {
  MasterScript script;
  script.start();
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kDisabled);
  EXPECT_EQ(script.master->drive_state(0).actual_counts, 1000);
  EXPECT_NEAR(script.master->positions()[0], 1000.0 / 400000 * 2 * kPi, 1e-12);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, repeats_a_request_and_gives_up_with_a_named_error) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);
  script.tick();
  script.tick({});
  script.bus.expect("601#4000100000000000");
  script.tick(std::chrono::milliseconds(1));
  script.bus.expect("77F#05");
  script.bus.expect("601#4000100000000000");
  script.tick(std::chrono::milliseconds(100));
  script.bus.expect("77F#05");
  script.bus.expect("601#4000100000000000");
  script.tick(std::chrono::milliseconds(100));
  script.bus.expect("77F#05");
  script.tick(std::chrono::milliseconds(100));
  script.tick(std::chrono::milliseconds(1));
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kFaulted);
  EXPECT_EQ(script.master->status(0).fault, Error::kSdoTimeout);
  EXPECT_EQ(script.master->counters().repeated, 2U);
  script.bus.expect_all_consumed();
}

// Operation enabled by a former master: stopped on its ramp by SDO, and reset when it stands.
TEST(MasterStartUp, stops_a_drive_that_is_found_moving_and_resets_it_at_rest) {
  MasterScript script;
  script.bus.expect("77F#05");
  script.bus.expect("601#4041600000000000", {"581#4B41600037120000"});
  script.tick();
  script.bus.expect("601#2B40600002000000", {"581#6040600000000000"});
  script.tick();
  const auto tick_with = [&](const char* position, int later_ms) {
    script.bus.expect("601#4064600000000000", {position});
    script.tick(std::chrono::milliseconds(later_ms));
  };
  tick_with("581#4364600000100000", 1);
  tick_with("581#4364600000180000", 1);
  tick_with("581#43646000001C0000", 10);
  tick_with("581#43646000011C0000", 10);  // at 24 ms the former is heard; a count is no motion
  tick_with("581#43646000001C0000", 10);
  tick_with("581#43646000001C0000", 10);
  script.bus.expect("77F#05");
  tick_with("581#43646000001C0000", 10);
  tick_with("581#43646000001C0000", 10);
  script.bus.expect("000#8201");
  script.tick(std::chrono::milliseconds(10));  // 50 ms later
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, resets_a_drive_that_does_not_answer_or_never_stands) {
  MasterScript silent;
  silent.bus.expect("77F#05");
  silent.bus.expect("601#4041600000000000");
  silent.tick();
  silent.bus.expect("77F#05");
  silent.bus.expect("000#8201");
  silent.tick(std::chrono::milliseconds(100));
  silent.bus.expect_all_consumed();

  // One that is pushed for ever.
  Configuration configuration = test::puma_drives(1);
  configuration.stop_timeout = std::chrono::milliseconds(30);
  MasterScript restless(configuration);
  restless.bus.expect("77F#05");
  restless.bus.expect("601#4041600000000000", {"581#4B41600017120000"});
  restless.tick();
  restless.bus.expect("601#4064600000000000", {"581#4364600000100000"});
  restless.tick(std::chrono::milliseconds(15));
  restless.bus.expect("601#4064600000000000", {"581#4364600000200000"});
  restless.tick(std::chrono::milliseconds(15));
  restless.bus.expect("601#4064600000000000");
  restless.bus.expect("000#8201");
  restless.tick(std::chrono::milliseconds(15));
  restless.bus.expect_all_consumed();
}

TEST(MasterStartUp, refuses_a_drive_that_counts_otherwise_than_configured) {
  struct Told {
    const char* gear;  // 6091h:01
    const char* feed;  // 6092h:01 of one revolution, or that it is not there
    std::optional<std::uint32_t> object;
  };
  // Configured are 4000 counts a revolution of the motor and a gear of 100; the encoder has 4000.
  for (const Told& told : {Told{"581#4391600101000000", "581#8092600100000206", std::nullopt},
                           Told{"581#4391600101000000", "581#43926001A00F0000", std::nullopt},
                           Told{"581#4391600164000000", "581#43926001801A0600", std::nullopt},
                           Told{"581#4391600150000000", "581#43926001801A0600", 0x6091},
                           Told{"581#4391600101000000", "581#4392600100100000", 0x6092}}) {
    MasterScript script;
    script.bus.expect("77F#05");
    test::script_reset(script.bus);
    test::script_inquiry(script.bus);
    if (!told.object) test::script_settings(script.bus);  // else nothing is written
    script.bus.replace("601#4091600100000000", told.gear);
    script.bus.replace("601#4092600100000000", told.feed);
    script.bus.replace("601#4092600200000000", "581#4392600201000000");
    for (int i = 0; i < 90 && script.master->node_state(0).phase != Phase::kStarted; ++i) {
      script.tick({});
    }
    script.bus.expect_all_consumed();
    EXPECT_EQ(script.master->status(0).fault.has_value(), told.object.has_value()) << told.feed;
    if (!told.object) continue;
    EXPECT_EQ(script.master->status(0).fault, Error::kScaleInvalid);
    EXPECT_EQ(script.master->status(0).fault_code, *told.object);
    EXPECT_EQ(script.master->status(0).fault_object.index, *told.object);
    EXPECT_NE(script.master->status(0).words, "");
  }
}

TEST(MasterStartUp, refuses_a_device_that_is_no_drive) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);
  script.tick();
  script.tick({});
  script.bus.expect("601#4000100000000000", {"581#4300100091010F00"});  // profile 401, I/O
  script.tick();
  script.tick();
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveWrongType);
  EXPECT_EQ(script.master->status(0).fault_code, 0x000F0191U);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, keeps_the_code_of_an_abort) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);
  script.tick();
  script.tick({});
  script.bus.expect("601#4000100000000000", {"581#8000100000000206"});
  script.tick();
  script.tick();
  EXPECT_EQ(script.master->status(0).fault, Error::kSdoAborted);
  EXPECT_EQ(script.master->status(0).words, "object does not exist");
  EXPECT_EQ(script.master->status(0).fault_object,
            (hal::DeviceObject{.index = 0x1000, .subindex = 0, .found = {}, .wanted = 402}));
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, begins_the_set_up_anew_when_power_up_and_reset_cross) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);  // of the power-up
  script.tick({});
  script.tick({});
  script.bus.expect("601#4000100000000000", {"581#4300100092010200"});
  script.tick({});
  script.bus.bring("701#00");  // of the reset
  script_set_up(script.bus);
  for (int i = 0; i < 90 && script.master->node_state(0).phase != Phase::kStarted; ++i) {
    script.tick({});
  }
  EXPECT_EQ(script.master->status(0).fault, std::nullopt);
  script.bus.expect_all_consumed();
}

void boot_three_times(MasterScript& script) {
  for (int i = 0; i < 3; ++i) {
    script.bus.bring("701#00");
    script.bus.expect("601#4000100000000000");
    script.tick({});
  }
}

// Once more than a drive may.
void boot_too_often(MasterScript& script) {
  script.bus.expect("77F#05");
  test::script_reset(script.bus, false);
  script.tick({});
  script.tick({});
  boot_three_times(script);
  script.bus.bring("701#00");
  script.tick({});
  script.tick({});
}

TEST(MasterStartUp, gives_up_a_drive_that_does_not_stay_up) {
  MasterScript script;
  boot_too_often(script);
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveRebooted);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, lets_a_drive_boot_as_often_again_after_the_operators_reset) {
  MasterScript script;
  boot_too_often(script);
  ASSERT_EQ(script.master->status(0).fault, Error::kDriveRebooted);
  script.master->reset_faults();
  script.bus.expect("000#8201");
  script.tick({});
  boot_three_times(script);
  EXPECT_FALSE(script.master->status(0).fault);
  script.bus.expect_all_consumed();
}

// Whether the drive stands is not known yet: it is reset all the same.
TEST(MasterStartUp, takes_no_boot_up_before_its_own_reset_for_the_begin_of_the_set_up) {
  MasterScript script;
  script.bus.expect("77F#05");
  script.bus.expect("601#4041600000000000");
  script.tick();
  script.bus.bring("701#00");
  script.tick();
  EXPECT_EQ(script.master->node_state(0).phase, Phase::kUnreset);
  script.bus.expect("77F#05");
  script.bus.expect("000#8201");
  script.tick(std::chrono::milliseconds(100));
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, waits_by_the_time_of_the_write_where_the_read_was_earlier) {
  MasterScript script;
  script.bus.expect("77F#05");
  script.bus.expect("601#4041600000000000");
  script.tick();
  EXPECT_TRUE(script.master->read(script.bus.now));
  script.bus.expect("77F#05");
  script.bus.expect("000#8201");
  EXPECT_TRUE(
      script.master->write(script.targets, script.bus.now + std::chrono::milliseconds(100)));
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, leaves_a_failed_drive_that_boots_again_to_the_operator) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus);
  script.tick();
  script.tick({});
  script.bus.expect("601#4000100000000000", {"581#4300100091010F00"});  // no drive
  script.tick();
  script.tick();
  ASSERT_EQ(script.master->node_state(0).phase, Phase::kFailed);
  script.bus.bring("701#00");
  script.tick();
  script.tick();
  EXPECT_EQ(script.master->node_state(0).phase, Phase::kFailed);
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveWrongType);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, reports_a_drive_that_does_not_boot) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus, false);
  script.tick();
  script.tick({});
  script.bus.expect("77F#05");
  script.bus.expect("000#8101");  // the whole node
  script.tick(std::chrono::milliseconds(2001));
  EXPECT_FALSE(script.master->status(0).fault);
  script.bus.expect("77F#05");
  script.tick(std::chrono::milliseconds(2001));
  EXPECT_EQ(script.master->status(0).fault, Error::kDriveAbsent);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, sets_up_a_drive_that_boots_after_a_reset_of_the_whole_node_alone) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus, false);
  script.tick();
  script.tick({});
  script.bus.expect("77F#05");
  script.bus.expect("000#8101", {"701#00"});
  script.tick(std::chrono::milliseconds(2001));
  test::script_set_up(script.bus);
  for (int i = 0; i < 90 && script.master->node_state(0).phase != Phase::kStarted; ++i) {
    script.tick({});
  }
  EXPECT_FALSE(script.master->status(0).fault);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, takes_a_boot_up_that_comes_after_it_has_given_up_waiting) {
  MasterScript script;
  script.bus.expect("77F#05");
  test::script_reset(script.bus, false);
  script.tick();
  script.tick({});
  script.bus.expect("77F#05");
  script.bus.expect("000#8101");
  script.tick(std::chrono::milliseconds(2001));
  script.bus.expect("77F#05");
  script.tick(std::chrono::milliseconds(2001));
  ASSERT_EQ(script.master->status(0).fault, Error::kDriveAbsent);
  script.bus.bring("701#00");
  test::script_set_up(script.bus);
  for (int i = 0; i < 90 && script.master->node_state(0).phase != Phase::kStarted; ++i) {
    script.tick({});
  }
  EXPECT_FALSE(script.master->status(0).fault);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, sends_nothing_while_the_bus_is_down_and_begins_when_it_is_up) {
  MasterScript script;
  script.bus.set_state(hal::CanState::kDown);
  script.tick();
  EXPECT_EQ(test::failure_of(script.read), Error::kBusDown);
  EXPECT_EQ(script.master->status(0).condition, DriveCondition::kStarting);
  script.bus.set_state(hal::CanState::kActive);
  script.bus.expect("77F#05");
  test::script_reset(script.bus, false);
  script.tick();
  script.tick({});
  EXPECT_TRUE(script.read);
  script.bus.expect_all_consumed();
}

TEST(MasterStartUp, refuses_to_enable_before_every_drive_is_ready) {
  MasterScript script;
  EXPECT_EQ(test::failure_of(script.master->enable()), Error::kDrivesNotReady);
}

TEST(MasterStartUp, starts_the_other_nodes_and_starts_them_again_after_their_boot_up) {
  Configuration configuration;
  configuration.axes.push_back(puma_axis(1));
  configuration.others[0].nodes.push_back(32);
  MasterScript script(configuration);
  script.bus.expect("77F#05");
  script.bus.expect("000#0120");
  test::script_reset(script.bus, false);
  script.tick();
  script.tick({});
  script.bus.bring("720#05");
  script.tick();
  script.bus.bring("720#00");
  script.bus.expect("000#0120");
  script.tick();
  script.bus.expect_all_consumed();
}

}  // namespace
}  // namespace armsig::canopen
