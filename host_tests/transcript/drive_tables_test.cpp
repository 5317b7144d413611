// SPDX-License-Identifier: MIT
// The master and a drive of each table, from power-up to a motion, or to the object that it is
// refused by.
#include "host_tests/support/drive_tables.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "host_tests/support/emulated_arm.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_drives.hpp"

namespace armsig::canopen {
namespace {

using hal::DriveCondition;
using std::chrono::milliseconds;
using test::DriveTable;
using test::EmulatedArm;

// Remembers the objects that somebody wrote.
class Writes final : public simulated::CanWatcher {
 public:
  std::map<std::uint16_t, unsigned> objects;

 private:
  void do_see(const hal::ReceivedCanFrame& received) override {
    const hal::CanFrame& frame = received.frame;
    const bool writes =
        (frame.id & kFunctionMask) == kSdoRequestId && (frame.data[0] & 0xE0) == 0x20;
    if (writes) ++objects[load<std::uint16_t>(frame, 1)];
  }
};

using cia402::PositionMode;

Configuration one_joint(const DriveTable& table, bool known,
                        PositionMode mode = PositionMode::kCyclic) {
  Configuration configuration = test::puma_drives(1);
  configuration.boot_timeout = milliseconds(100);
  configuration.axes[0].scaling.counts_per_revolution = table.counts_per_revolution;
  configuration.axes[0].unsupervised_known = known;
  configuration.axes[0].mode = mode;
  return configuration;
}

std::string name_of(const hal::DeviceObject& object) {
  char name[16];
  std::snprintf(name, sizeof name, "%04Xh:%u", object.index, object.subindex);
  return name;
}

// What comes of a drive: "moves", or the object that it is refused by.
std::string outcome_of(const DriveTable& table, PositionMode mode = PositionMode::kCyclic) {
  EmulatedArm arm(one_joint(table, true, mode), nullptr, table.drive());
  Writes writes;
  arm.bus.set_watcher(&writes);
  for (int i = 0; i < 1000 && !arm.master->status(0).fault; ++i) {
    if (arm.master->all(DriveCondition::kDisabled)) break;
    arm.tick();
  }
  if (const auto fault = arm.master->status(0).fault) {
    const hal::DeviceObject object = arm.master->status(0).fault_object;
    if (object.index == 0x6502) EXPECT_TRUE(writes.objects.empty()) << "read before writing";
    EXPECT_TRUE(object.wanted);
    return name_of(object);
  }
  if (!arm.power_up_and_enable()) return "is not enabled";
  for (int i = 0; i < 300; ++i) {
    arm.tick([&] { arm.targets[0] += 0.001; });
  }
  arm.run(mode == PositionMode::kProfile ? 300 : 20);
  return std::fabs(arm.master->positions()[0] - 0.3) < 1e-3 ? "moves" : "does not follow";
}

TEST(DriveTables, of_invented_drives_are_set_up_and_moved_or_refused_by_an_object) {
  const auto tables = test::invented_drive_tables();
  ASSERT_EQ(tables.size(), 5U);
  for (const DriveTable& table : tables) EXPECT_EQ(outcome_of(table), table.outcome) << table.name;
}

struct NamedMode {
  PositionMode mode;
  const char* name;  // in the configuration
};
constexpr std::array kModes{NamedMode{PositionMode::kCyclic, "cyclic"},
                            NamedMode{PositionMode::kInterpolated, "interpolated"},
                            NamedMode{PositionMode::kProfile, "profile"}};

// The first mode in which a drive moves.
std::optional<NamedMode> mode_of(const DriveTable& table) {
  for (const NamedMode& named : kModes) {
    if (outcome_of(table, named.mode) == "moves") return named;
  }
  return std::nullopt;
}

TEST(DriveTables, of_drives_that_are_sold_are_refused_by_an_object_in_a_mode_that_they_lack) {
  const std::map<std::string, std::string> refused{{"Schunk LWA4P joint (scanned)", "1600h:2"},
                                                   {"Pilz PRBT joint (DCF)", "6502h:0"},
                                                   {"Maxon EPOS2 70/10", "6502h:0"},
                                                   {"Maxon EPOS4 50/5", "6502h:0"}};
  const auto tables = test::shared_drive_tables();
  if (tables.empty()) GTEST_SKIP() << "without the shared data";
  for (const DriveTable& table : tables) {
    const auto found = refused.find(table.name);
    EXPECT_EQ(outcome_of(table), found == refused.end() ? "moves" : found->second) << table.name;
  }
}

TEST(DriveTables, of_drives_that_are_sold_are_set_up_and_moved_in_a_mode_that_they_have) {
  const auto tables = test::shared_drive_tables();
  if (tables.empty()) GTEST_SKIP() << "without the shared data";
  EXPECT_EQ(tables.size(), 9U);
  for (const DriveTable& table : tables) EXPECT_TRUE(mode_of(table)) << table.name;
}

// A row of the guide: by which mode a drive is moved, and which of the objects that its table tells
// of it goes without.
std::string row_of(const DriveTable& table) {
  const auto named = mode_of(table);
  if (!named) return table.name + " is not set up";
  EmulatedArm arm(one_joint(table, true, named->mode), nullptr, table.drive());
  arm.run(500);
  std::string gaps;
  for (const hal::DeviceObject& gap : arm.master->setup_report(0).gaps) {
    const bool told = gap.index == 0x1016 || gap.index >= 0x6000;
    if (told) gaps += (gaps.empty() ? "" : ", ") + name_of(gap);
  }
  return "| " + table.name + " | `" + named->name + "` | " + (gaps.empty() ? "-" : gaps) + " |";
}

TEST(DriveTables, of_drives_that_are_sold_stand_in_the_guide) {
  const auto tables = test::shared_drive_tables();
  if (tables.empty()) GTEST_SKIP() << "without the shared data";
  std::ifstream file(ARMSIG_GUIDE);
  std::stringstream guide;
  guide << file.rdbuf();
  for (const DriveTable& table : tables) {
    const std::string row = row_of(table);
    EXPECT_NE(guide.str().find(row + "\n"), std::string::npos) << row;
  }
}

// Enabled, and then its master is killed: whether it has torque half a second later.
bool keeps_torque(const DriveTable& table) {
  EmulatedArm arm(one_joint(table, true), nullptr, table.drive());
  EXPECT_TRUE(arm.power_up_and_enable()) << table.name;
  arm.clock.wait_until(arm.clock.now() + milliseconds(500));
  return arm.drives[0].state() == cia402::State::kOperationEnabled;
}

TEST(DriveTables, tell_of_every_drive_whether_it_stops_when_its_master_is_killed) {
  auto tables = test::invented_drive_tables();
  for (const DriveTable& table : test::shared_drive_tables()) tables.push_back(table);
  unsigned kept = 0;
  for (const DriveTable& table : tables) {
    EmulatedArm arm(one_joint(table, false), nullptr, table.drive());
    if (!arm.run_until(DriveCondition::kDisabled, 1000)) continue;
    const bool unsupervised = arm.master->status(0).unsupervised;
    EXPECT_EQ(keeps_torque(table), unsupervised) << table.name;
    EXPECT_EQ(arm.master->enable().has_value(), !unsupervised) << table.name;
    if (!unsupervised) continue;
    ++kept;
    EXPECT_EQ(test::failure_of(arm.master->enable()), Error::kDriveUnsupervised);
  }
  EXPECT_GT(kept, 0U);
}

// The RPDO time-out in place of the heartbeat: what the drive goes without is told.
TEST(DriveTables, without_a_heartbeat_consumer_are_watched_by_their_commands) {
  const DriveTable table = test::invented_drive_tables()[0];
  EmulatedArm arm(one_joint(table, false), nullptr, table.drive());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 1000));
  const cia402::SetupReport& report = arm.master->setup_report(0);
  EXPECT_TRUE(report.is_supervised());
  EXPECT_EQ(arm.drives[0].dictionary().get(0x1400, 5), 150U);
  ASSERT_EQ(report.gaps.size(), 2U);
  EXPECT_EQ(report.gaps[0].index, 0x1016);
  EXPECT_EQ(report.gaps[1],
            (hal::DeviceObject{.index = 0x605B, .subindex = 0, .found = 0, .wanted = 1}));
}

// Neither heartbeat consumer nor RPDO time-out: its master asks it, and its own heartbeat is off.
TEST(DriveTables, that_can_be_guarded_alone_are_asked_by_their_master) {
  const DriveTable table = test::invented_drive_tables().back();
  EmulatedArm arm(one_joint(table, false), nullptr, table.drive());
  ASSERT_TRUE(arm.power_up_and_enable());
  arm.run(500);
  EXPECT_TRUE(arm.master->setup_report(0).guarded);
  EXPECT_EQ(arm.drives[0].dictionary().get(0x100C), 50U);
  EXPECT_EQ(arm.drives[0].dictionary().get(0x100D), 3U);
  EXPECT_EQ(arm.drives[0].dictionary().get(0x1017), 0U);
  EXPECT_EQ(arm.master->status(0).condition, DriveCondition::kEnabled) << "its answers are heard";
  arm.drives[0].inject(simulated::DriveFault::kHeartbeatLost);
  arm.run(200);
  EXPECT_EQ(arm.master->status(0).fault, Error::kHeartbeatLost);
}

TEST(DriveTables, with_another_mode_in_operation_enabled_are_refused_there) {
  DriveTable table = test::invented_drive_tables()[0];
  EmulatedArm arm(one_joint(table, false), nullptr, table.drive());
  ASSERT_TRUE(arm.run_until(DriveCondition::kDisabled, 1000));
  ASSERT_TRUE(arm.master->enable());
  for (int i = 0; i < 1000 && !arm.master->status(0).fault; ++i) {
    arm.drives[0].set_object(0x6060, 0, 1);
    EXPECT_NE(arm.master->status(0).condition, DriveCondition::kEnabled);
    arm.tick();
  }
  EXPECT_EQ(arm.master->status(0).fault, Error::kSdoUnexpectedValue);
  EXPECT_EQ(arm.master->status(0).fault_object,
            (hal::DeviceObject{.index = 0x6061, .subindex = 0, .found = 1, .wanted = 8}));
}

}  // namespace
}  // namespace armsig::canopen
