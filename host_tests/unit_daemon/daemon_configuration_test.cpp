// SPDX-License-Identifier: MIT
// Every way in which a controller's configuration can be wrong is refused at its place in the file.
#include "firmware/linux/daemon_configuration.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/unit_daemon/changed_configuration.hpp"

namespace armsig::daemon {
namespace {

TEST(DaemonConfiguration, of_the_reference_is_read_as_it_is_written) {
  const auto read = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(read) << tool::render(read.error());
  const controller::Configuration& c = read->controller;
  EXPECT_EQ(read->name, "Puma 560");
  EXPECT_EQ(read->can_interfaces, std::vector<std::string>{"can0"});
  EXPECT_EQ(c.period, std::chrono::milliseconds(2));
  ASSERT_EQ(c.drawing.joints.size(), 6U);
  EXPECT_DOUBLE_EQ(c.drawing.joints[1].a_m, 0.4318);
  EXPECT_DOUBLE_EQ(c.drawing.limits[1].lower, radians(-225));
  EXPECT_DOUBLE_EQ(c.limits.speed[3], radians(90));
  EXPECT_DOUBLE_EQ(c.limits.acceleration[0], radians(180));
  EXPECT_DOUBLE_EQ(c.supervision.following_error[5], radians(3));
  EXPECT_DOUBLE_EQ(c.sweeps.configuration[2], radians(90));
  EXPECT_DOUBLE_EQ(c.sweeps.arc_rad, radians(180));
  EXPECT_EQ(read->drives.axes[4].node, 5);
  EXPECT_DOUBLE_EQ(read->drives.axes[4].scaling.gear_ratio, 100);
  EXPECT_EQ(c.sensor.receivers.p_S.size(), 8U);
  EXPECT_DOUBLE_EQ(c.sensor.receivers.range_sigma_m, 0.2e-3);
  EXPECT_EQ(c.grid.grid.vertex_count(), 252U);
  EXPECT_EQ(c.grid.taught[0].size(), 6U);
  EXPECT_EQ(c.grid.dwell, std::chrono::milliseconds(100));
  ASSERT_TRUE(std::holds_alternative<linux_hal::RtuRangeSensorConfiguration>(read->sensor));
  const auto& line = std::get<linux_hal::RtuRangeSensorConfiguration>(read->sensor);
  EXPECT_EQ(line.parity, 'E');
  EXPECT_EQ(line.profile.receivers, 8U);
  // Table of bit times of docs: SYNC, twelve PDOs and seven heartbeats at 1 Mbit/s.
  EXPECT_GT(read->bus_loads.at(0), 0.6);
  EXPECT_LT(read->bus_loads.at(0), 0.8);
}

TEST(DaemonConfiguration, places_the_arm_of_a_virtual_controller) {
  const std::string place =
      "virtual: {base: {x_mm: 100, y_mm: -200, z_m: -1.5, rz_deg: 90}}\nmotion:";
  const auto read = parse_configuration(change("\nmotion:", "motion:", place).text, "c.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  ASSERT_TRUE(read->virtual_base);
  EXPECT_TRUE(read->virtual_base->p.isApprox(Vector3(0.1, -0.2, -1.5)));
  EXPECT_TRUE((read->virtual_base->R * Vector3::UnitX()).isApprox(Vector3::UnitY()));
  EXPECT_FALSE(read_configuration(ARMSIG_REFERENCE)->virtual_base);
}

TEST(DaemonConfiguration, names_the_files_of_touches) {
  const Changed changed =
      change("accept_sent", "accept_sent", "touches: {file: t.csv, plan: p.csv}\naccept_sent");
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_EQ(read->touches.file, "t.csv");
  EXPECT_EQ(read->touches.plan, "p.csv");
  EXPECT_TRUE(read_configuration(ARMSIG_REFERENCE)->touches.file.empty());
}

TEST(DaemonConfiguration, refuses_touches_without_a_file_of_their_own) {
  const auto refused = [](const std::string& touches, const std::string& words) {
    expect_refused("accept_sent", "accept_sent", "touches: " + touches + "\naccept_sent", words);
  };
  refused("{plan: p.csv}", "file");
  refused("{file: \"\"}", "file");
  refused("{file: [a, b]}", "file");
  refused("{file: t.csv, plan: t.csv}", "plan: the file of the touches");
  refused("{file: t.csv, places: [A1]}", "places");
  refused("t.csv", "touches");
}

TEST(DaemonConfiguration, has_sockets_for_a_virtual_controller) {
  const Changed changed = change(
      "\nmotion:", "motion:",
      "virtual: {ball: {x_mm: 1, y_mm: 2, z_mm: 150}, sockets: [{place: A1, x_mm: 400, y_mm: 0, "
      "z_mm: 50}, {place: A2, x_m: 0.1, y_mm: 0, z_mm: 50}], seat_sigma_mm: 0.1}\nmotion:");
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const cabinet::EmulatedSockets& sockets = read->virtual_sockets;
  ASSERT_EQ(sockets.all.size(), 2U);
  EXPECT_EQ(sockets.all[1].name(), "A2");
  EXPECT_TRUE(sockets.all[1].p_0.isApprox(Vector3(0.1, 0, 0.05)));
  EXPECT_TRUE(sockets.ball_F.isApprox(Vector3(0.001, 0.002, 0.15)));
  EXPECT_DOUBLE_EQ(sockets.seat_sigma_m, 0.1e-3);
  EXPECT_FALSE(read->virtual_base);
}

TEST(DaemonConfiguration, refuses_sockets_that_no_ball_can_be_led_into) {
  const auto refused = [](const std::string& keys, const std::string& words) {
    expect_refused("\nmotion:", "motion:", "virtual: {" + keys + "}\nmotion:", words);
  };
  const std::string ball = "ball: {x_mm: 0, y_mm: 0, z_mm: 150}, ";
  refused("sockets: [{place: A1, x_mm: 1, y_mm: 1, z_mm: 1}]", "ball");
  refused(ball + "sockets: []", "sockets");
  refused(ball + "sockets: [{place: A1, x_mm: 1, y_mm: 1}]", "z");
  refused(ball + "sockets: [{place: \"A,1\", x_mm: 1, y_mm: 1, z_mm: 1}]", "place");
  refused(ball + "sockets: [{place: A1, x_m: 1000, y_mm: 1, z_mm: 1}]", "x: 1000");
  refused(ball +
              "sockets: [{place: A1, x_mm: 1, y_mm: 1, z_mm: 1}, {place: A1, x_mm: 1, y_mm: 1, "
              "z_mm: 1}]",
          "place: A1 twice");
  refused(ball + "sockets: [{place: A1, x_mm: 1, y_mm: 1, z_mm: 1}], seat_sigma_m: 5",
          "seat_sigma: 5");
  refused("base: {x_mm: 0, y_mm: 0, z_mm: 0}, " + ball.substr(0, ball.size() - 2),
          "ball without sockets");
}

TEST(DaemonConfiguration, turns_a_virtual_base_about_x_then_y_then_z_of_the_sensor) {
  const std::string place =
      "virtual: {base: {x_mm: 0, y_mm: 0, z_mm: 0, rx_deg: 90, ry_deg: 90, rz_deg: 90}}\nmotion:";
  const auto read = parse_configuration(change("\nmotion:", "motion:", place).text, "c.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_TRUE((read->virtual_base->R * Vector3::UnitY()).isApprox(Vector3::UnitY()));
  EXPECT_TRUE((read->virtual_base->R * Vector3::UnitX()).isApprox(-Vector3::UnitZ()));
}

TEST(DaemonConfiguration, refuses_a_virtual_base_that_is_no_place) {
  const auto refused = [](const std::string& section, const std::string& words) {
    expect_refused("\nmotion:", "motion:", section + "\nmotion:", words);
  };
  refused("virtual: {base: {x_mm: 0, y_mm: 0}}", "z");
  refused("virtual: {base: {x_m: 0, y_m: 0, z_m: -1200}}", "no arm is as large");
  refused("virtual: {place: {x_mm: 0}}", "place");
  refused("virtual: {}", "base");
}

TEST(DaemonConfiguration, of_a_sensor_on_can_counts_its_frames_and_starts_its_node) {
  std::string text = change("  modbus:", "  modbus:", "  can: {node: 32}\n  mo: ").text;
  text = text.substr(0, text.find("  mo: ")) + text.substr(text.find("\nmotion:") + 1);
  for (const char* last : {"    - {x_mm: 500,   y_mm: 500,   z_mm: 800}\n",
                           "    - {x_mm: -500,  y_mm: 500,   z_mm: 800}\n"}) {
    const std::size_t at = text.find(last);
    ASSERT_NE(at, std::string::npos);
    text.erase(at, std::string(last).size());
  }
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_TRUE(std::holds_alternative<canopen::RangeNodeConfiguration>(read->sensor));
  ASSERT_EQ(read->drives.others[0].nodes.size(), 1U);
  EXPECT_EQ(read->drives.others[0].nodes[0], 32);
  EXPECT_EQ(read->drives.others[0].traffic.size(), 4U);
}

TEST(DaemonConfiguration, refuses_an_unknown_key_and_names_the_one_that_was_meant) {
  expect_refused("can:", "heartbeat_timeout_ms", "heartbeat_timout_ms", "heartbeat_timeout_ms");
  expect_refused("joints:", "gear_ratio", "gearing", "unknown key");
  expect_refused("dwell:", "most_pings", "max_pings", "most_pings");
}

TEST(DaemonConfiguration, refuses_a_key_without_its_unit) {
  expect_refused("joints:", "speed_deg_per_s: 60", "speed: 60", "speed_deg_per_s");
  expect_refused("armsig:", "period_ms: 2", "period: 2", "period_ms");
}

TEST(DaemonConfiguration, refuses_units_of_the_other_type_of_joint) {
  expect_refused("joints:", "limits_deg: [-160, 160]", "limits_mm: [-160, 160]", "limits_deg");
  expect_refused("joints:", "speed_deg_per_s: 60", "speed_mm_per_s: 60", "speed_deg_per_s");
  expect_refused("joints:", "sweep_at_deg: 0", "sweep_at_mm: 0", "sweep_at_deg");
}

TEST(DaemonConfiguration, refuses_degrees_told_as_radians) {
  expect_refused("joints:", "limits_deg: [-160, 160]", "limits_rad: [-160, 160]", "wrong unit");
}

TEST(DaemonConfiguration, takes_a_drive_that_keeps_its_torque_for_known_in_one_word) {
  const auto plain = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->drives.axes[0].unsupervised_known);
  const auto known = parse_configuration(
      change("joints:", "reversed: no", "reversed: no, unsupervised: known").text, "cabinet.yaml");
  ASSERT_TRUE(known) << tool::render(known.error());
  EXPECT_TRUE(known->drives.axes[0].unsupervised_known);
  EXPECT_FALSE(known->drives.axes[1].unsupervised_known);
  expect_refused("joints:", "reversed: no", "reversed: no, unsupervised: yes",
                 "known, or no such key");
}

TEST(DaemonConfiguration, watches_the_torque_of_a_joint_in_sequences_where_it_says_so) {
  const auto plain = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(plain);
  EXPECT_FALSE(plain->drives.axes[0].torque_told);
  EXPECT_FALSE(plain->controller.supervision.sequence_torque[0]);
  const auto watched = parse_configuration(
      change("joints:", "reversed: no", "reversed: no, sequence_torque_percent: 60").text,
      "cabinet.yaml");
  ASSERT_TRUE(watched) << tool::render(watched.error());
  EXPECT_TRUE(watched->drives.axes[0].torque_told);
  EXPECT_EQ(watched->controller.supervision.sequence_torque[0], 0.6);
  EXPECT_FALSE(watched->drives.axes[1].torque_told);
  EXPECT_FALSE(watched->controller.supervision.sequence_torque[1]);
  for (const char* beyond : {"0", "301", "60.5"}) {
    expect_refused("joints:", "reversed: no",
                   "reversed: no, sequence_torque_percent: " + std::string(beyond),
                   "sequence_torque_percent");
  }
}

TEST(DaemonConfiguration, takes_a_warning_of_a_drive_for_known_in_one_word) {
  const auto known = parse_configuration(
      change("joints:", "reversed: no", "reversed: no, warning: known").text, "cabinet.yaml");
  ASSERT_TRUE(known) << tool::render(known.error());
  EXPECT_TRUE(known->drives.axes[0].warning_known);
  EXPECT_FALSE(known->drives.axes[1].warning_known);
  expect_refused("joints:", "reversed: no", "reversed: no, warning: ignored",
                 "known, or no such key");
}

TEST(DaemonConfiguration, takes_a_joint_that_counts_from_power_up) {
  const auto plain = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->controller.references[0], controller::Reference::kAbsolute);
  const auto counting = parse_configuration(
      change("joints:", "reversed: no", "reversed: no, reference: none").text, "cabinet.yaml");
  ASSERT_TRUE(counting) << tool::render(counting.error());
  EXPECT_EQ(counting->controller.references[0], controller::Reference::kNone);
  EXPECT_EQ(counting->controller.references[1], controller::Reference::kAbsolute);
  expect_refused("joints:", "reversed: no", "reversed: no, reference: relative",
                 "absolute, homed or none");
}

TEST(DaemonConfiguration, takes_a_joint_whose_drive_homes_and_the_method) {
  const auto homed = parse_configuration(
      change("joints:", "reversed: no", "reversed: no, reference: homed, homing_method: -3").text,
      "cabinet.yaml");
  ASSERT_TRUE(homed) << tool::render(homed.error());
  EXPECT_EQ(homed->controller.references[0], controller::Reference::kHomed);
  EXPECT_EQ(homed->drives.axes[0].homing_method, -3);
  EXPECT_FALSE(homed->drives.axes[1].homing_method);
  expect_refused("joints:", "reversed: no", "reversed: no, homing_method: 17", "reference: homed");
  expect_refused("joints:", "reversed: no", "reversed: no, reference: homed, homing_method: 128",
                 "-128 to 127");
}

TEST(DaemonConfiguration, refuses_reversed_limits) {
  expect_refused("joints:", "[-225, 45]", "[45, -225]", "the lower limit first");
}

TEST(DaemonConfiguration, refuses_a_joint_without_limits) {
  const std::string limits = " limits_deg: [-160, 160],";
  const Changed changed = change("joints:", limits, "");
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("limits_deg"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_a_joint_without_end_by_its_name) {
  expect_refused("joints:", "limits_deg: [-160, 160]", "limits: none",
                 "limits of joint 1 are none, or have no unit");
}

TEST(DaemonConfiguration, refuses_a_node_that_is_given_twice) {
  expect_refused("joints:", "node: 4", "node: 3", "node 3");
  expect_refused("joints:", "node: 6", "node: 127", "node 127");
}

TEST(DaemonConfiguration, refuses_a_node_that_cannot_be) {
  expect_refused("joints:", "node: 1", "node: 128", "1 to 127");
  expect_refused("joints:", "node: 1", "node: 0", "1 to 127");
}

TEST(DaemonConfiguration, refuses_counts_in_a_wrong_unit) {
  expect_refused("joints:", "counts_per_revolution: 4000", "counts_per_revolution: 4", "counts");
  expect_refused("joints:", "counts_per_revolution: 4000", "counts_per_revolution: -4000",
                 "not a positive number");
  const Changed fine =
      change("joints:", "counts_per_revolution: 4000", "counts_per_revolution: 4e9");
  const auto read = parse_configuration(fine.text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("32-bit counts"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_a_bus_that_would_be_overloaded) {
  expect_refused("armsig:", "period_ms: 2", "period_ms: 1", "at most 80 %");
}

TEST(DaemonConfiguration, refuses_a_period_that_drives_cannot_be_told) {
  const Changed changed = change("armsig:", "period_ms: 2", "period_ms: 2.0005");
  EXPECT_FALSE(parse_configuration(changed.text, "cabinet.yaml"));
}

TEST(DaemonConfiguration, refuses_a_heartbeat_that_is_slower_than_its_time_out) {
  const Changed changed = change("can:", "heartbeat_ms: 50", "heartbeat_ms: 500");
  EXPECT_FALSE(parse_configuration(changed.text, "cabinet.yaml"));
}

TEST(DaemonConfiguration, refuses_receivers_that_cannot_locate_a_target) {
  std::string text = change("sensor:", "z_mm: 0}", "z_mm: 0}").text;
  for (std::size_t at = text.find("z_mm: 800"); at != std::string::npos;
       at = text.find("z_mm: 800")) {
    text.replace(at, 9, "z_mm: 0");
  }
  text.replace(text.find("facing: [0, 0, -1]"), 18, "facing: [1, 0, 0]");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("one plane"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_a_sensor_on_no_bus_or_on_two) {
  expect_refused("sensor:", "  modbus:", "  can: {node: 32}\n  modbus:", "two buses");
  std::string text = change("sensor:", "  modbus:", "  mo: ").text;
  text = text.substr(0, text.find("  mo: ")) + text.substr(text.find("\nmotion:") + 1);
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("no bus"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_a_signature_configuration_outside_the_limits) {
  expect_refused("joints:", "sweep_at_deg: 30", "sweep_at_deg: 175", "joint limit");
}

// The reference with a workspace box in place of its line about one.
std::string with_box(const std::string& box) {
  return change("# Optional: a box", "# workspace:", "workspace: " + box + " #").text;
}

TEST(DaemonConfiguration, has_a_workspace_box_where_one_is_told) {
  EXPECT_FALSE(read_configuration(ARMSIG_REFERENCE)->controller.around.has_box());
  const std::string sides = "x_mm: [-1200, 1200], y_mm: [-1150, 1200], z_m: [-1, 1.2]";
  auto read = parse_configuration(with_box("{" + sides + "}"), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const clearance::Surroundings& around = read->controller.around;
  EXPECT_EQ(around.lower_B, Vector3(-1.2, -1.15, -1));
  EXPECT_EQ(around.upper_B, Vector3(1.2, 1.2, 1.2));
  EXPECT_DOUBLE_EQ(around.hand_m, std::hypot(0.15, 0.05)) << "as far as the emitter";
  read = parse_configuration(with_box("{" + sides + ", hand_mm: 170}"), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_DOUBLE_EQ(read->controller.around.hand_m, 0.17);
  read = parse_configuration(with_box("{hand_mm: 20}"), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_DOUBLE_EQ(read->controller.around.hand_m, 0.02);
  EXPECT_FALSE(read->controller.around.has_box());
}

TEST(DaemonConfiguration, keeps_clear_of_floor_and_links_unless_it_says_otherwise) {
  const auto read = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(read) << tool::render(read.error());
  const clearance::Surroundings& around = read->controller.around;
  ASSERT_EQ(around.planes.size(), 1U);
  EXPECT_EQ(around.planes[0].limit, clearance::Limit::kFloor);
  EXPECT_DOUBLE_EQ(around.planes[0].offset_m, -0.672);
  EXPECT_NEAR(around.link_radius_m, 0.045, 0.001);
  // Without a word about it the floor is where the base is bolted down.
  const auto bolted = parse_configuration(change("floor_mm", "floor_mm: 672", "").text, "c.yaml");
  ASSERT_TRUE(bolted) << tool::render(bolted.error());
  ASSERT_EQ(bolted->controller.around.planes.size(), 1U);
  EXPECT_EQ(bolted->controller.around.planes[0].limit, clearance::Limit::kMountingPlane);
  const auto& [above, below] =
      std::pair(bolted->controller.sweeps.free[1], read->controller.sweeps.free[1]);
  EXPECT_LT(above.upper - above.lower, below.upper - below.lower);
}

TEST(DaemonConfiguration, sweeps_each_joint_over_an_arc_of_its_own_where_that_is_told) {
  const auto all = read_configuration(ARMSIG_REFERENCE);
  ASSERT_TRUE(all);
  const auto one = parse_configuration(
      change("joints:", "sweep_at_deg: 30}", "sweep_at_deg: 30, sweep_arc_deg: 70}").text,
      "cabinet.yaml");
  ASSERT_TRUE(one) << tool::render(one.error());
  for (std::size_t joint = 0; joint < 6; ++joint) {
    EXPECT_DOUBLE_EQ(controller::arc_of(one->controller.sweeps, joint),
                     radians(joint == 3 ? 70 : 180));
  }
}

TEST(DaemonConfiguration, refuses_a_workspace_box_by_what_is_wrong_with_it) {
  const auto refused = [](const std::string& box, const std::string& words) {
    expect_refused("# Optional: a box", "# workspace:", "workspace: " + box + " #", words);
  };
  refused("{x_mm: [-1200, 1200], y_mm: [-1200, 1200]}", "z_mm");
  refused("{x_mm: [-1200, 1200], y_mm: [-1200, 1200], z_mm: 3}", "z_mm");
  refused("{x_mm: [-1200, 1200], y_mm: [-1200, 1200], z_mm: [1200, -1000]}", "workspace.z");
  refused("{x_m: [-1200, 1200], y_mm: [-1200, 1200], z_mm: [-1000, 1200]}", "millimetres as");
  refused("{x_mm: [-1200, 1200], y_mm: [-1200, 1200], z_mm: [-1000, 1200], hand_mm: 900}",
          "what the flange carries is");
  // In the unit of its sides.
  refused("{x_m: [-1.2, 1.2], y_m: [-1.2, 1.2], z_m: [-1, 0.9], hand_mm: 160}",
          "m beyond the box; it ends at");
  refused("{x_mm: [-1200, 1200], y_mm: [-20, 1200], z_mm: [-1000, 1200], hand_mm: 0.1}",
          "mm beyond the box; it ends at");
}

TEST(DaemonConfiguration, refuses_counts_of_points_and_pings_that_cannot_be) {
  expect_refused("sweeps:", "points: 24", "points: 3", "sweeps.points");
  expect_refused("sweeps:", "most_points: 48", "most_points: 500", "sweeps.most_points");
  expect_refused("dwell:", "pings: 5", "pings: 0", "pings");
  expect_refused("sweeps:", "validation_poses: 8", "validation_poses: 1", "validation_poses");
  expect_refused("check:", "poses: 16", "poses: 5", "check.poses");
  expect_refused("check:", "poses: 16", "poses: 17", "check.poses");
  expect_refused("check:", "every_hours: 0", "every_hours: -1", "every_hours");
  expect_refused("check:", "every_hours: 0", "every_hours: 721", "every_hours");
}

TEST(DaemonConfiguration, refuses_what_is_not_positive_or_no_number) {
  expect_refused("joints:", "speed_deg_per_s: 60", "speed_deg_per_s: 0", "above 0");
  expect_refused("joints:", "following_error_deg: 3", "following_error_deg: .nan", "not a");
  expect_refused("joints:", "motor_speed_deg_per_s: 120", "motor_speed_deg_per_s: 12", "below");
  expect_refused("motion:", "tool_speed_mm_per_s: 250", "tool_speed_mm_per_s: -250", "above 0");
  expect_refused("supervision:", "latest_tick_ms: 10", "latest_tick_ms: 1e9", "at most a day");
  expect_refused("sensor:", "air_c: [0, 45]", "air_c: [45, 0]", "lowest");
}

TEST(DaemonConfiguration, refuses_what_no_arm_is_like_and_says_why) {
  expect_refused("supervision:", "latest_tick_ms: 10", "latest_tick_s: 3600", "not supervised");
  expect_refused("joints:", "following_error_deg: 3", "following_error_rad: 100",
                 "follows nothing");
  expect_refused("node: 2,", "speed_deg_per_s: 60", "speed_rad_per_s: 1e6", "degrees as radians?");
  expect_refused("joints:", "acceleration_deg_per_s2: 180", "acceleration_rad_per_s2: 1e6",
                 "degrees as radians?");
  expect_refused("dwell:", "tolerance_rad_or_m: 1.0e-4", "tolerance_rad_or_m: 0.06",
                 "does not stand still");
  for (const char* slip :
       {"heartbeat_ms: 1 ", "heartbeat_timeout_s: 60 ", "sdo_timeout_s: 60 ",
        "transition_timeout_s: 600 ", "boot_timeout_s: 600 ", "targets_ignored_s: 600 ",
        "limited_s: 600 ", "lagging_s: 600 ", "voltage_lost_s: 600 ", "warning_s: 6000 "}) {
    const std::string key(slip, std::string_view(slip).rfind('_'));
    std::string text = change("can:", "  " + key + "_ms: ", "  " + std::string(slip) + "#").text;
    const auto read = parse_configuration(text, "cabinet.yaml");
    ASSERT_FALSE(read) << slip;
    EXPECT_NE(tool::render(test::failure_of(read)).find("the bound here is"), std::string::npos)
        << slip;
  }
}

// What the drives are disbelieved by: a wrong unit here would switch those checks off.
TEST(DaemonConfiguration, refuses_motors_and_windows_that_would_disbelieve_nothing) {
  expect_refused("joints:", "motor_speed_deg_per_s: 120", "motor_speed_rad_per_s: 1e5",
                 "no position would be an outlier");
  expect_refused("joints:", "sweep_at_deg: 0}", "sweep_at_deg: 0, following_window_rad: 100}",
                 "follows nothing");
}

TEST(DaemonConfiguration, refuses_a_stop_that_would_lose_its_torque_in_mid_ramp) {
  expect_refused("can:", "stop_timeout_ms: 1500", "stop_timeout_ms: 300", "from 0.333333 to 60");
}

TEST(DaemonConfiguration, refuses_a_sensor_that_could_never_be_heard) {
  expect_refused("sensor:", "poll_period_ms: 20", "poll_period_ms: 0.001", "from 0.001 to 10");
  expect_refused("sensor:", "answer_timeout_ms: 100", "answer_timeout_ms: 0.1", "from 0.001 to 10");
  expect_refused("sensor:", "silent_after_ms: 500", "silent_after_ms: 30", "two readings");
  expect_refused("sensor:", "stale_after_ms: 500", "stale_after_ms: 30", "two readings");
  expect_refused("sensor:", "seconds_a_step: 1.0e-9", "seconds_a_step: 1", "seconds");
  expect_refused("sensor:", "celsius_a_step: 0.1", "celsius_a_step: 100", "kelvins");
  expect_refused("sensor:", "emitter: {x_mm: 150", "emitter: {x_m: 150", "millimetres as metres?");
}

TEST(DaemonConfiguration, refuses_words_that_it_does_not_know) {
  expect_refused("sensor:", "parity: even", "parity: mark", "even, odd or none");
  expect_refused("sensor:", "path: one-way", "path: both", "one-way or echo");
  expect_refused("sensor:", "words: high-first", "words: big", "high-first");
  expect_refused("joints:", "reversed: no", "reversed: maybe", "yes or no");
  expect_refused("can:", "interface: can0", "interface: can-of-a-very-long-name", "15 characters");
}

TEST(DaemonConfiguration, refuses_registers_too_far_apart_for_one_request) {
  const Changed changed = change("sensor:", "first_flight: 4", "first_flight: 400");
  const auto read = parse_configuration(changed.text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("125 registers"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_a_grid_that_the_arm_cannot_reach_and_corners_outside_limits) {
  const std::string head = reference().substr(0, reference().find("\ngrid:") + 1);
  const auto too_large = parse_configuration(
      head + "grid: {size_mm: [90000, 90000, 90000], count: [2, 2, 2], corners: automatic}\n", "f");
  ASSERT_FALSE(too_large);
  EXPECT_NE(tool::render(test::failure_of(too_large)).find("out of reach"), std::string::npos);
  const std::string corner =
      "{q1_deg: 0, q2_deg: -90, q3_deg: 90, q4_deg: 0, q5_deg: 200, q6_deg: 0}";
  const auto outside = parse_configuration(
      head + "grid: {size_mm: [10, 10, 10], count: [2, 2, 2], corners: {origin: " + corner +
          ", on_x: " + corner + ", in_xy: " + corner + "}}\n",
      "f");
  ASSERT_FALSE(outside);
  EXPECT_NE(tool::render(test::failure_of(outside)).find("joint limit"), std::string::npos);
}

TEST(DaemonConfiguration, refuses_another_kind_of_file) {
  const auto read = parse_configuration("armsig: arm/1\nname: x\n", "arm.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("controller/1"), std::string::npos);
  EXPECT_FALSE(read_configuration("/nonexistent/cabinet.yaml"));
}

}  // namespace
}  // namespace armsig::daemon
