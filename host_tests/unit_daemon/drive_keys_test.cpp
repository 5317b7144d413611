// SPDX-License-Identifier: MIT
// What the configuration file says of drives, and of the devices beside them.
#include "firmware/linux/drive_keys.hpp"

#include <gtest/gtest.h>

#include "host_tests/unit_daemon/changed_configuration.hpp"

namespace armsig::daemon {
namespace {

TEST(DriveKeys, takes_how_a_drive_is_given_its_targets) {
  const auto read_mode = [](const std::string& mode) {
    const auto read = parse_configuration(
        change("joints:", "reversed: no", "reversed: no, mode: " + mode).text, "cabinet.yaml");
    EXPECT_TRUE(read) << tool::render(read.error());
    EXPECT_EQ(read->drives.axes[1].mode, cia402::PositionMode::kCyclic) << "of the others";
    return read->drives.axes[0].mode;
  };
  EXPECT_EQ(read_mode("cyclic"), cia402::PositionMode::kCyclic);
  EXPECT_EQ(read_mode("interpolated"), cia402::PositionMode::kInterpolated);
  EXPECT_EQ(read_mode("profile"), cia402::PositionMode::kProfile);
  expect_refused("joints:", "reversed: no", "reversed: no, mode: csp",
                 "cyclic, interpolated or profile");
}

TEST(DriveKeys, takes_two_joints_of_one_drive_by_their_axes) {
  const auto read =
      parse_configuration(change("joints:", "node: 2,", "node: 1, axis: 2,").text, "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->drives.axes[0].node, 1);
  EXPECT_EQ(read->drives.axes[0].axis, 1);
  EXPECT_EQ(read->drives.axes[1].node, 1);
  EXPECT_EQ(read->drives.axes[1].axis, 2);
  expect_refused("joints:", "node: 2,", "node: 2, axis: 0,", "axis");
  expect_refused("joints:", "node: 2,", "node: 2, axis: 5,", "axis");
  expect_refused("joints:", "node: 2,", "node: 2, axis: 9,", "axis");
  expect_refused("joints:", "node: 2,", "node: 1,", "joint 2: ");
  expect_refused("joints:", "node: 2,", "node: 1, axis: 1,", "two axes of it");
}

TEST(DriveKeys, takes_objects_that_are_written_besides) {
  const auto read = parse_configuration(
      change("joints:", "reversed: no",
             "reversed: no, writes: [{object: 6081h:0, bytes: 4, value: 4294967295}, "
             "{object: 2abcH:12, bytes: 1, value: -2}]")
          .text,
      "cabinet.yaml");
  EXPECT_FALSE(read) << "an h is small";
  const auto two = parse_configuration(
      change("joints:", "reversed: no",
             "reversed: no, writes: [{object: 6081h:0, bytes: 4, value: 4294967295}, "
             "{object: 2abch:12, bytes: 1, value: -2}]")
          .text,
      "cabinet.yaml");
  ASSERT_TRUE(two) << tool::render(two.error());
  const auto& writes = two->drives.axes[0].writes;
  ASSERT_EQ(writes.size(), 2U);
  EXPECT_EQ(writes[0].index, 0x6081);
  EXPECT_EQ(writes[0].value, 0xFFFFFFFFU);
  EXPECT_EQ(writes[1].index, 0x2ABC);
  EXPECT_EQ(writes[1].subindex, 12);
  EXPECT_EQ(writes[1].bytes, 1);
  EXPECT_EQ(writes[1].value, 0xFEU);
  EXPECT_TRUE(two->drives.axes[1].writes.empty());
}

TEST(DriveKeys, refuses_objects_that_are_not_free_or_have_no_such_value) {
  const auto refused = [](const std::string& write, const std::string& words) {
    expect_refused("joints:", "reversed: no", "reversed: no, writes: [{" + write + "}]", words);
  };
  refused("object: 6060h:0, bytes: 1, value: 8", "is not free to be written");
  refused("object: 1016h:1, bytes: 4, value: 8", "is not free to be written");
  refused("object: 6860h:0, bytes: 1, value: 8", "is not free to be written");
  refused("object: 0x6081, bytes: 4, value: 8", "such as 6081h:0");
  refused("object: 6081h:256, bytes: 4, value: 8", "such as 6081h:0");
  refused("object: \"6081h:\", bytes: 4, value: 8", "such as 6081h:0");
  refused("object: 608gh:0, bytes: 4, value: 8", "such as 6081h:0");
  refused("object: 6081h:0, bytes: 3, value: 8", "1, 2 or 4");
  refused("object: 6081h:0, bytes: 2, value: 65536", "from -32768 to 65535");
  refused("object: 6081h:0, bytes: 2, value: 1.5", "a whole number");
  refused("object: 6081h:0, bytes: 2", "value");
  refused("object: 6081h:0, bytes: 2, value: 1, subindex: 0", "unknown key");
  expect_refused("joints:", "reversed: no", "reversed: no, writes: []", "writes");
}

TEST(DriveKeys, takes_devices_that_are_started_with_the_drives) {
  const auto read = parse_configuration(
      change("can:", "interface: can0", "interface: can0\n  other_nodes: [40, 41, 42]").text,
      "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  ASSERT_EQ(read->drives.others[0].nodes.size(), 3U);
  EXPECT_EQ(read->drives.others[0].nodes[2], 42);
  const auto refused = [](const std::string& nodes, const std::string& words) {
    expect_refused("can:", "interface: can0", "other_nodes: " + nodes + "\n  interface: can0",
                   words);
  };
  refused("[3]", "no joint's");
  refused("[127]", "not the master's");
  refused("[40, 40]", "named once");
  refused("[0]", "1 to 127");
  refused("[40, 41, 42, 43]", "other_nodes");
  refused("40", "other_nodes");
}

}  // namespace
}  // namespace armsig::daemon
