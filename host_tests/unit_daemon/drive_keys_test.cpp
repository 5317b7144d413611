// SPDX-License-Identifier: MIT
// What the configuration file says of drives, and of the devices beside them.
#include "firmware/linux/drive_keys.hpp"

#include <algorithm>
#include <string>
#include <vector>

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

// The reference with three joints on a second interface, and `change` to that.
std::string on_two_interfaces() {
  std::string text =
      change("can:", "interface: can0", "interface: can0\n  second_interface: can1").text;
  for (const char* node : {"node: 4,", "node: 5,", "node: 6,"}) {
    text.insert(text.find(node), "interface: can1, ");
  }
  return text;
}
std::string with(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  return text;
}
void expect_refused_at(const std::string& text, const std::string& place,
                       const std::string& words) {
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read) << place;
  const std::string message = tool::render(read.error());
  const std::size_t at = text.find(place);
  EXPECT_EQ(test::failure_of(read).line,
            1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'))
      << message;
  EXPECT_GT(test::failure_of(read).column, 0) << message;
  EXPECT_NE(message.find(words), std::string::npos) << message;
}

TEST(DriveKeys, takes_drives_on_two_interfaces) {
  const auto read = parse_configuration(on_two_interfaces(), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->can_interfaces, (std::vector<std::string>{"can0", "can1"}));
  EXPECT_EQ(read->drives.buses.count, 2);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_EQ(read->drives.axes[joint].bus, joint / 3) << joint;
  }
  ASSERT_EQ(read->bus_loads.size(), 2U);
  EXPECT_LT(read->bus_loads[0], 0.5);
  EXPECT_EQ(read->bus_loads[0], read->bus_loads[1]);
  EXPECT_EQ(interfaces_in_words(*read), "can0 and can1");
}

TEST(DriveKeys, takes_the_same_node_on_two_interfaces_and_1_kHz) {
  const auto read = parse_configuration(
      with(with(on_two_interfaces(), "node: 4,", "node: 1,"), "period_ms: 2", "period_ms: 1"),
      "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->drives.axes[3].node, 1);
  EXPECT_GT(read->bus_loads[1], 0.7);
}

TEST(DriveKeys, refuses_an_interface_that_the_section_can_does_not_have) {
  expect_refused("joints:", "node: 2,", "node: 2, interface: can1,", "second_interface");
  const std::string text = with(on_two_interfaces(), "can1, node: 5", "can7, node: 5");
  expect_refused_at(text, "interface: can7", "can0 or can1");
}

TEST(DriveKeys, refuses_a_node_twice_on_one_of_two_interfaces) {
  const std::string text = with(on_two_interfaces(), "node: 5,", "node: 4, zero_counts: 1,");
  expect_refused_at(text, "node: 4, zero_counts: 1,", "joint 5: ");
  expect_refused_at(text, "node: 4, zero_counts: 1,", "node 4 on can1");
}

TEST(DriveKeys, refuses_a_second_interface_that_is_the_first_or_has_no_drive) {
  expect_refused_at(with(on_two_interfaces(), "second_interface: can1", "second_interface: can0"),
                    "second_interface: can0", "another interface than the first");
  expect_refused("can:", "interface: can0", "second_interface: can1\n  interface: can0",
                 "\"can1\" has no drive");
  std::string text = on_two_interfaces();
  for (const char* node : {"node: 1,", "node: 2,", "node: 3,"}) {
    text.insert(text.find(node), "interface: can1, ");
  }
  expect_refused_at(text, "  interface: can0", "\"can0\" has no drive");
  expect_refused_at(with(on_two_interfaces(), "second_interface: can1",
                         "second_interface: can-of-a-very-long-name"),
                    "second_interface: can-of", "15 characters");
}

TEST(DriveKeys, refuses_a_load_above_the_bound_on_one_of_two_interfaces) {
  std::string text = with(on_two_interfaces(), "period_ms: 2", "period_ms: 1");
  text.insert(text.find("node: 3,"), "interface: can1, ");
  expect_refused_at(text, "period_ms: 1", " on can1: ");
}

TEST(DriveKeys, takes_other_devices_of_each_interface) {
  const std::string text = with(on_two_interfaces(), "second_interface: can1",
                                "second_interface: can1\n  other_nodes: [40]\n"
                                "  second_other_nodes: [1, 40]");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->drives.others[0].nodes.size(), 1U);
  ASSERT_EQ(read->drives.others[1].nodes.size(), 2U);
  EXPECT_EQ(read->drives.others[1].nodes[0], 1) << "which is a joint's on the first only";
  expect_refused_at(with(text, "[1, 40]", "[4]"), "second_other_nodes: [4]", "no joint's");
  expect_refused("can:", "interface: can0", "second_other_nodes: [40]\n  interface: can0",
                 "without second_interface");
}

TEST(DriveKeys, takes_a_sensor_on_the_second_interface) {
  const std::string base = on_two_interfaces();
  const std::size_t at = base.find("  modbus:");
  const auto sensor = [&](const std::string& keys) {
    std::string text = base.substr(0, at) + "  can: {" + keys + "}\n";
    text.replace(text.find("    - {x_mm: 500,   y_mm: 500,   z_mm: 800}\n"), 44, "");
    text.replace(text.find("    - {x_mm: -500,  y_mm: 500,   z_mm: 800}\n"), 44, "");
    return text;
  };
  const auto read = parse_configuration(sensor("node: 1, interface: can1"), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->drives.buses.sink, 1);
  EXPECT_EQ(read->drives.others[1].nodes[0], 1);
  EXPECT_TRUE(read->drives.others[0].nodes.empty());
  expect_refused_at(sensor("node: 4, interface: can1"), "can: {node: 4", "node 4 on can1");
  expect_refused_at(sensor("node: 40, interface: can2"), "can: {node: 40", "can0 or can1");
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
