// SPDX-License-Identifier: MIT
// What a look at the drives finds of each table, and that it writes nothing.
#include "firmware/linux/drive_scan.hpp"

#include <array>
#include <chrono>
#include <deque>
#include <map>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "firmware/linux/drive_words.hpp"
#include "hal/canopen/drive_setup.hpp"
#include "hal/canopen/master.hpp"
#include "hal/simulated/virtual_can_bus.hpp"
#include "hal/simulated/virtual_clock.hpp"
#include "host_tests/support/drive_tables.hpp"
#include "host_tests/support/puma_drives.hpp"
#include "host_tests/support/scripted_can_bus.hpp"

namespace armsig::daemon {
namespace {

using std::chrono::milliseconds;
using test::DriveTable;

// Every frame that the looking one sends is an SDO upload.
class OnlyUploads final : public simulated::CanWatcher {
 public:
  unsigned asked = 0;

 private:
  void do_see(const hal::ReceivedCanFrame& received) override {
    const hal::CanFrame& frame = received.frame;
    const std::uint32_t function = frame.id & canopen::kFunctionMask;
    if (function == canopen::kSdoResponseId || function == canopen::kHeartbeatId) return;
    ASSERT_EQ(function, canopen::kSdoRequestId) << test::text(frame);
    ASSERT_EQ(frame.data[0] & 0xE0, 0x40) << test::text(frame);
    ++asked;
  }
};

// Drives of these tables on nodes 1, 2, ..., of which the first `joints` are configured.
struct Bus {
  Bus(const std::vector<DriveTable>& tables, std::uint8_t joints,
      const cia402::FurtherWrites& writes = {}) {
    canopen::Configuration drives = test::puma_drives(joints);
    drives.axes[0].writes = writes;
    for (std::size_t i = 0; i < joints; ++i) {
      const double counts = i < tables.size() ? tables[i].counts_per_revolution : 4000;
      drives.axes[i].scaling.counts_per_revolution = counts;
    }
    configuration.emplace(*canopen::check(drives));
    bus.connect(port);
    bus.set_watcher(&watcher);
    for (const DriveTable& table : tables) {
      simulated::DriveConfiguration drive = table.drive();
      drive.node = static_cast<std::uint8_t>(motors.size() + 1);
      drive.serial = 1000U + drive.node;
      ports.emplace_back();
      motors.emplace_back(drive, ports.back());
      bus.connect(ports.back(), &motors.back());
    }
    clock.add(bus);
    scan.emplace(*configuration, port);
  }

  void look() {
    for (int i = 1; i < 60'000; ++i) {
      clock.wait_until(hal::Instant(milliseconds(i)));
      if (!scan->step(clock.now())) return;
    }
    ADD_FAILURE() << "it does not end";
  }

  simulated::VirtualClock clock;
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort port;
  std::deque<simulated::VirtualCanPort> ports;
  std::deque<simulated::Drive> motors;
  OnlyUploads watcher;
  std::optional<canopen::CheckedConfiguration> configuration;
  std::optional<DriveScan> scan;
};

// "set up", or the object by which a drive would be refused.
std::string verdict(const DriveTable& table) {
  Bus one({table}, 1);
  one.look();
  EXPECT_GT(one.watcher.asked, 127U);
  const Rehearsal setup = rehearse(one.scan->nodes().at(0), *one.configuration);
  EXPECT_EQ(all_would_be_set_up(one.scan->nodes(), *one.configuration), !setup.refusal);
  if (!setup.refusal) return "set up";
  std::ostringstream object;
  object << std::hex << std::uppercase << setup.refusal->object.index << "h";
  return object.str();
}

TEST(DriveScan, foresees_of_every_drive_that_is_sold_whether_it_would_be_set_up) {
  const std::map<std::string, std::string> refused{{"Pilz PRBT joint (DCF)", "6502h"},
                                                   {"Maxon EPOS2 70/10", "6502h"},
                                                   {"Maxon EPOS4 50/5", "6502h"}};
  const auto tables = test::shared_drive_tables();
  if (tables.empty()) GTEST_SKIP() << "without the shared data";
  for (const DriveTable& table : tables) {
    const auto found = refused.find(table.name);
    EXPECT_EQ(verdict(table), found == refused.end() ? "set up" : found->second) << table.name;
  }
}

TEST(DriveScan, names_a_mode_of_the_drive_that_would_do) {
  DriveTable table = test::invented_drive_tables()[1];
  const auto words_of = [&](std::uint32_t modes) {
    table.edits.push_back({.object = {0x6502, 0, 4, simulated::Access::kReadOnly, modes}});
    const std::vector tables{table};
    Bus one(tables, 1);
    one.look();
    return drives_in_words(*one.scan, *one.configuration);
  };
  EXPECT_NE(words_of(0x43).find("\"mode: interpolated\" would do"), std::string::npos);
  EXPECT_NE(words_of(0x05).find("\"mode: profile\" would do"), std::string::npos);
  EXPECT_NE(words_of(0x0C).find("it knows no mode of positions"), std::string::npos);
}

TEST(DriveScan, tells_what_the_configuration_writes_besides) {
  const auto words_of = [](const cia402::FurtherWrites& writes) {
    const std::vector tables{test::invented_drive_tables()[1]};
    Bus one(tables, 1, writes);
    one.look();
    return drives_in_words(*one.scan, *one.configuration);
  };
  const std::string written = words_of({{0x6099, 1, 4, 20000}, {0x6081, 0, 4, 1000}});
  EXPECT_NE(written.find("6099h:1 by the configuration       0x7D0       0x4E20\n"),
            std::string::npos)
      << written;
  EXPECT_NE(written.find("6081h:0 profile speed              0x7A120     0x3E8\n"),
            std::string::npos)
      << written;
  const std::string refused = words_of({{0x2345, 6, 2, 77}});
  EXPECT_NE(refused.find("2345h:6 by the configuration       absent      -           refused\n"),
            std::string::npos)
      << refused;
  EXPECT_NE(refused.find("refused at 2345h:6: found nothing, wanted 0x4D"), std::string::npos)
      << refused;
}

// What only a write tells it can't foresee: an option that is read-only.
TEST(DriveScan, foresees_what_can_be_read_of_invented_drives) {
  for (const DriveTable& table : test::invented_drive_tables()) {
    EXPECT_EQ(verdict(table), "set up") << table.name;
  }
}

TEST(DriveScan, tells_what_it_would_write_and_what_is_gone_without) {
  const auto tables = test::invented_drive_tables();
  Bus two({tables[0], tables[1]}, 2);
  two.look();
  const std::string words = drives_in_words(*two.scan, *two.configuration);
  EXPECT_NE(words.find("node 1, joint 1: drive of CiA 402\n"), std::string::npos) << words;
  EXPECT_NE(words.find(" serial 0x3E9\n"), std::string::npos) << words;
  EXPECT_NE(words.find("Switch on disabled, no error, mode 0, at 0 counts = 0.000 deg\n"),
            std::string::npos)
      << words;
  EXPECT_NE(words.find("\n  modes not reported\n"), std::string::npos) << words;
  EXPECT_NE(words.find("\n  modes: profile position, profile velocity, homing, cyclic synchronous "
                       "position\n"),
            std::string::npos)
      << words;
  EXPECT_NE(
      words.find("1016h:1 watches master's heartbeat absent      -           does not see that "
                 "this process dies\n"),
      std::string::npos)
      << words;
  EXPECT_NE(words.find("605Ah:0 quick stop                 0x2         0x6\n"), std::string::npos)
      << words;
  EXPECT_NE(words.find("  would be set up\n"), std::string::npos) << words;
  EXPECT_NE(words.find("  would be set up; holds torque when this process dies\n"),
            std::string::npos)
      << words;
  std::istringstream lines(words);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST(DriveScan, names_a_joint_without_a_drive_a_node_of_nobody_and_another_master) {
  const auto tables = test::invented_drive_tables();
  Bus bus({tables[0], tables[1]}, 1);
  EXPECT_TRUE(bus.scan->nodes().empty());
  simulated::VirtualCanPort stranger;
  bus.bus.set_watcher(nullptr);
  bus.bus.connect(stranger);
  ASSERT_TRUE(stranger.send(canopen::sync_frame()));
  bus.look();
  const std::string words = drives_in_words(*bus.scan, *bus.configuration);
  EXPECT_TRUE(words.starts_with("another master is on the bus\n")) << words;
  EXPECT_NE(words.find("node 2, not configured: drive of CiA 402\n"), std::string::npos) << words;

  Bus lonely({}, 1);
  lonely.look();
  EXPECT_EQ(drives_in_words(*lonely.scan, *lonely.configuration),
            "node 1, joint 1: does not answer\n");
  EXPECT_FALSE(all_would_be_set_up(lonely.scan->nodes(), *lonely.configuration));
}

TEST(DriveScan, sees_two_devices_that_answer_as_one_node) {
  const auto table = test::invented_drive_tables()[0];
  Bus bus({table}, 1);
  simulated::VirtualCanPort port;
  simulated::DriveConfiguration twin = table.drive();
  twin.node = 1;
  simulated::Drive drive(twin, port);
  bus.bus.connect(port, &drive);
  bus.look();
  EXPECT_EQ(bus.scan->nodes().at(0).answers, 2U);
  EXPECT_FALSE(all_would_be_set_up(bus.scan->nodes(), *bus.configuration));
}

TEST(DriveScan, is_told_to_programs) {
  const auto tables = test::invented_drive_tables();
  Bus bus({tables[1]}, 1);
  bus.look();
  const auto json = nlohmann::json::parse(drives_as_json(*bus.scan, *bus.configuration));
  EXPECT_EQ(json["armsig"], "drives/1");
  const auto& node = json["nodes"][0];
  EXPECT_EQ(node["joint"], 1);
  EXPECT_EQ(node["set_up"], true);
  EXPECT_EQ(node["supervised"], false);
  bool seen = false;
  for (const auto& object : node["objects"]) {
    if (object["object"] != "6007h:0") continue;
    seen = true;
    EXPECT_TRUE(object["found"].is_null());
    EXPECT_EQ(object["abort"], 0x06020000);
    EXPECT_EQ(object["costs"], "holds torque when this process dies");
  }
  EXPECT_TRUE(seen);
}

// Two buses, each with a drive of node 1.
TEST(DriveScan, names_the_interface_of_a_drive_where_there_are_two) {
  canopen::Configuration drives = test::puma_drives(2);
  drives.buses.count = 2;
  drives.axes[1].node = 1;
  drives.axes[1].bus = 1;
  const auto configuration = canopen::check(drives);
  ASSERT_TRUE(configuration);
  std::vector<DriveScan> scans;
  std::string words;
  for (const std::uint8_t number : {std::uint8_t{0}, std::uint8_t{1}}) {
    simulated::VirtualClock clock;
    simulated::VirtualCanBus bus;
    simulated::VirtualCanPort port;
    simulated::VirtualCanPort drive_port;
    simulated::Drive drive({.node = 1}, drive_port);
    bus.connect(port);
    if (number == 0) bus.connect(drive_port, &drive);
    clock.add(bus);
    scans.emplace_back(*configuration, port, number, number == 0 ? "can0" : "can1");
    for (int i = 1; i < 60'000 && scans.back().step(clock.now()); ++i) {
      clock.wait_until(hal::Instant(milliseconds(i)));
    }
    words += drives_in_words(scans.back(), *configuration);
  }
  EXPECT_TRUE(words.starts_with("node 1 on can0, joint 1: drive of CiA 402\n")) << words;
  EXPECT_TRUE(words.ends_with("node 1 on can1, joint 2: does not answer\n")) << words;
  EXPECT_TRUE(all_would_be_set_up(scans[0].nodes(), *configuration)) << words;
  EXPECT_FALSE(all_would_be_set_up(scans[1].nodes(), *configuration)) << words;
  const auto json = nlohmann::json::parse(drives_as_json(scans, *configuration));
  ASSERT_EQ(json["nodes"].size(), 2U);
  EXPECT_EQ(json["nodes"][0]["interface"], "can0");
  EXPECT_EQ(json["nodes"][1]["interface"], "can1");
  EXPECT_EQ(json["nodes"][1]["joint"], 2);
}

// Two axes in a node, of which `joints` are configured as the axes of joints.
struct DualBus {
  explicit DualBus(std::uint8_t joints, std::span<const simulated::ObjectEdit> edits = {}) {
    configuration.emplace(*canopen::check(test::puma_on_dual_drives(joints)));
    bus.connect(port);
    bus.set_watcher(&watcher);
    for (const int axis : {1, 2}) {
      simulated::DriveConfiguration drive;
      drive.node = 1;
      drive.axis = {.number = static_cast<std::uint8_t>(axis), .emulated = 0b11};
      if (axis == 2) drive.edits = edits;
      ports.emplace_back();
      motors.emplace_back(drive, ports.back());
      bus.connect(ports.back(), &motors.back());
    }
    clock.add(bus);
    scan.emplace(*configuration, port);
    for (int i = 1; i < 60'000 && scan->step(clock.now()); ++i) {
      clock.wait_until(hal::Instant(milliseconds(i)));
    }
  }
  [[nodiscard]] std::string words() const { return drives_in_words(*scan, *configuration); }

  simulated::VirtualClock clock;
  simulated::VirtualCanBus bus;
  simulated::VirtualCanPort port;
  std::deque<simulated::VirtualCanPort> ports;
  std::deque<simulated::Drive> motors;
  OnlyUploads watcher;
  std::optional<canopen::CheckedConfiguration> configuration;
  std::optional<DriveScan> scan;
};

TEST(DriveScan, tells_each_axis_of_a_node_by_its_own_objects) {
  DualBus both(2);
  const std::string words = both.words();
  EXPECT_NE(words.find("node 1, axis 1, joint 1: drive of CiA 402"), std::string::npos) << words;
  EXPECT_NE(words.find("node 1, axis 2, joint 2: drive of CiA 402"), std::string::npos) << words;
  EXPECT_NE(words.find("605Ah:0"), std::string::npos) << words;
  EXPECT_NE(words.find("685Ah:0"), std::string::npos) << words;
  EXPECT_NE(words.find("1640h:1"), std::string::npos) << words;
  EXPECT_TRUE(all_would_be_set_up(both.scan->nodes(), *both.configuration)) << words;
  const auto json = nlohmann::json::parse(drives_as_json(*both.scan, *both.configuration));
  ASSERT_EQ(json["nodes"].size(), 2U);
  EXPECT_EQ(json["nodes"][1]["axis"], 2);
  EXPECT_EQ(json["nodes"][1]["joint"], 2);
}

TEST(DriveScan, refuses_an_axis_by_its_own_object) {
  constexpr std::array<simulated::ObjectEdit, 1> kNoCyclic{
      {{.object = {0x6502, 0, 4, simulated::Access::kReadOnly, 1}}}};
  DualBus both(2, kNoCyclic);
  EXPECT_NE(both.words().find("refused at 6D02h:0: found 0x1, wanted 0x80"), std::string::npos)
      << both.words();
  EXPECT_NE(both.words().find("\"mode: profile\" would do"), std::string::npos) << both.words();
  EXPECT_FALSE(all_would_be_set_up(both.scan->nodes(), *both.configuration));
}

TEST(DriveScan, shows_an_axis_that_nobody_has_configured) {
  DualBus one(1);
  ASSERT_EQ(one.scan->nodes().size(), 2U) << one.words();
  EXPECT_NE(one.words().find("node 1, axis 2, not configured: drive of CiA 402"), std::string::npos)
      << one.words();
  EXPECT_TRUE(all_would_be_set_up(one.scan->nodes(), *one.configuration));
}

// With nobody on the bus no frame is acknowledged, and the queue of a socket stays full.
class FullBus final : public hal::CanBus {
 private:
  Result<void> do_send(const hal::CanFrame& /*frame*/) override {
    return room_-- > 0 ? Result<void>{} : std::unexpected(Error::kBusBusy);
  }
  std::optional<hal::ReceivedCanFrame> do_receive() override { return std::nullopt; }
  hal::CanStatus do_status() override { return {.state = hal::CanState::kPassive}; }

  int room_ = 10;
};

TEST(DriveScan, ends_where_the_bus_takes_no_frames) {
  const auto configuration = canopen::check(test::puma_drives(1));
  ASSERT_TRUE(configuration);
  FullBus full;
  DriveScan scan(*configuration, full);
  hal::Instant now{};
  int steps = 0;
  while (scan.step(now) && ++steps < 5000) now += milliseconds(1);
  EXPECT_LT(steps, 2000);
  EXPECT_TRUE(scan.is_stuck());
}

// One table of rules: what the set-up prefers, needs or compares has words here.
TEST(DriveScan, has_words_for_every_object_that_the_set_up_weighs) {
  canopen::Configuration drives = test::puma_drives(1);
  drives.axes[0].stop_deceleration = 10;
  drives.axes[0].following_window = 0.1;
  drives.axes[0].torque_told = true;
  const auto checked = canopen::check(drives);
  ASSERT_TRUE(checked);
  for (const auto& step : canopen::drive_setup(*checked, 0)) {
    const bool weighed =
        step.rule != cia402::SetupRule::kIfPresent && step.rule != cia402::SetupRule::kMust;
    if (!weighed) continue;
    bool found = false;
    for (const ObjectWords& words : object_words()) {
      if (words.index != step.request.index || words.subindex != step.request.subindex) continue;
      found = true;
      EXPECT_TRUE(!cia402::is_option(step.rule) || !words.cost.empty()) << words.what;
    }
    EXPECT_TRUE(found) << std::hex << step.request.index;
  }
}

// "EPOS4 50/5" as in CiA 301, 7.2.4.3.5: the length, then seven characters a segment.
TEST(TextUpload, puts_segments_together) {
  TextUpload upload(5, 0x1008, milliseconds(100));
  const hal::Instant now{};
  const auto exchange = [&](const char* asked, const char* answer) {
    const auto frame = upload.poll(now);
    ASSERT_TRUE(frame);
    EXPECT_EQ(test::text(*frame), asked);
    upload.take(test::frame(answer));
  };
  exchange("605#4008100000000000", "585#410810000A000000");
  exchange("605#6000000000000000", "585#0045504F53342035");
  exchange("605#7000000000000000", "585#19302F3500000000");
  EXPECT_TRUE(upload.is_over());
  EXPECT_EQ(upload.text(), "EPOS4 50/5");
}

TEST(TextUpload, ends_where_it_is_refused_cut_or_too_long) {
  const hal::Instant now{};
  TextUpload refused(5, 0x1008, milliseconds(100));
  EXPECT_TRUE(refused.poll(now));
  refused.take(test::frame("585#8008100000000206"));
  EXPECT_TRUE(refused.is_over());
  TextUpload silent(5, 0x1008, milliseconds(100));
  EXPECT_TRUE(silent.poll(now));
  EXPECT_FALSE(silent.poll(now + milliseconds(101)));
  EXPECT_TRUE(silent.is_over());
  TextUpload endless(5, 0x1008, milliseconds(100));
  EXPECT_TRUE(endless.poll(now));
  endless.take(test::frame("585#41081000FF000000"));
  for (int i = 0; i < 100 && !endless.is_over(); ++i) {
    EXPECT_TRUE(endless.poll(now));
    endless.take(test::frame(i % 2 == 0 ? "585#0041414141414141" : "585#1041414141414141"));
  }
  EXPECT_TRUE(endless.is_over());
  EXPECT_EQ(endless.text().size(), TextUpload::kLongest);
  TextUpload unprinted(5, 0x1008, milliseconds(100));
  EXPECT_TRUE(unprinted.poll(now));
  unprinted.take(test::frame("585#41081000FF000000"));
  for (int i = 0; i < 100 && !unprinted.is_over(); ++i) {
    EXPECT_TRUE(unprinted.poll(now));
    unprinted.take(test::frame(i % 2 == 0 ? "585#0000000000000000" : "585#1000000000000000"));
  }
  EXPECT_TRUE(unprinted.is_over());
  EXPECT_EQ(unprinted.text(), "");
}

}  // namespace
}  // namespace armsig::daemon
