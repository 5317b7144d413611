// SPDX-License-Identifier: MIT
// What measures, in the configuration file: a sensor, an instrument of points, or nothing.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "firmware/linux/daemon_configuration.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::daemon {
namespace {

// The reference without the grid, with `instrument` in place of its sensor.
std::string with(const std::string& instrument) {
  std::ifstream file(ARMSIG_REFERENCE);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = text.substr(0, text.find("\ngrid:") + 1);
  const std::size_t begin = text.find("\nsensor:") + 1;
  return text.replace(begin, text.find("\nmotion:") + 1 - begin, instrument);
}

// The key that the reference explains in remarks.
std::string of_reference(const std::string& key) {
  std::ifstream file(ARMSIG_REFERENCE);
  std::string points;
  for (std::string line; std::getline(file, line);) {
    const bool begins = line == "# " + key + ":";
    if (begins || (!points.empty() && line.starts_with("#   "))) points += line.substr(2) + "\n";
    if (!points.empty() && line.empty()) break;
  }
  return points;
}

constexpr const char* kLeast =
    "points:\n  target: {x_mm: 150, y_mm: 0, z_mm: 50}\n  port: 7047\n  sigma_mm: 0.05\n";

void expect_refused(const std::string& instrument, const std::string& words) {
  const auto read = parse_configuration(with(instrument), "cabinet.yaml");
  ASSERT_FALSE(read) << instrument;
  const std::string message = tool::render(read.error());
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_GT(test::failure_of(read).line, 0) << message;
  EXPECT_FALSE(test::failure_of(read).expected.empty()) << message;
}

TEST(PointConfiguration, of_the_reference_is_read_whole) {
  const auto read = parse_configuration(with(of_reference("points")), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto* points = std::get_if<linux_hal::LineServerConfiguration>(&read->sensor);
  ASSERT_NE(points, nullptr);
  EXPECT_EQ(points->address, "127.0.0.1");
  EXPECT_EQ(points->port, 7047);
  EXPECT_EQ(points->client, "192.168.5.20");
  EXPECT_EQ(points->age, std::chrono::milliseconds(100));
  EXPECT_EQ(points->freshness.silent_after, std::chrono::milliseconds(500));
  EXPECT_EQ(read->controller.sensor.measures, controller::Measures::kPoints);
  EXPECT_DOUBLE_EQ(read->controller.sensor.point_sigma_m, 0.05e-3);
  EXPECT_DOUBLE_EQ(read->p_nT.x(), 0.15);
}

TEST(PointConfiguration, is_only_for_this_computer_by_default) {
  const auto read = parse_configuration(with(kLeast), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto& points = std::get<linux_hal::LineServerConfiguration>(read->sensor);
  EXPECT_TRUE(linux_hal::is_loopback(points.address));
  EXPECT_TRUE(points.client.empty());
  const linux_hal::LineServerConfiguration defaults;
  EXPECT_EQ(points.age, defaults.age);
}

TEST(PointConfiguration, that_cannot_be_is_refused_in_its_place) {
  const std::string least = kLeast;
  expect_refused("points:\n  port: 7047\n  sigma_mm: 0.05\n", "target");
  expect_refused("points:\n  target: {x_mm: 1, y_mm: 0, z_mm: 5}\n  port: 7047\n", "sigma");
  expect_refused("points:\n  target: {x_mm: 1, y_mm: 0, z_mm: 5}\n  sigma_mm: 1\n", "port");
  expect_refused(least + "  address: localhost\n", "address: \"localhost\"");
  expect_refused(least + "  client: 192.168.5\n", "client: \"192.168.5\"");
  expect_refused(least + "  sensor: yes\n", "sensor");
  expect_refused(least + "  age_ms: 70000\n", "no instrument tells a point as late");
  for (const char* port : {"0", "80", "65536", "x"}) {
    expect_refused("points:\n  target: {x_mm: 1, y_mm: 0, z_mm: 5}\n  sigma_mm: 1\n  port: " +
                       std::string(port) + "\n",
                   "port");
  }
  for (const char* sigma : {"0", "0.0001", "51"}) {
    expect_refused("points:\n  target: {x_mm: 1, y_mm: 0, z_mm: 5}\n  port: 7047\n  sigma_mm: " +
                       std::string(sigma) + "\n",
                   "sigma");
  }
}

constexpr const char* kAsked =
    "points:\n  target: {x_mm: 150, y_mm: 0, z_mm: 50}\n  sigma_mm: 0.05\n";

// The part of the reference about a Modbus TCP server.
std::string server_of_reference() {
  std::ifstream file(ARMSIG_REFERENCE);
  std::string server;
  for (std::string line; std::getline(file, line);) {
    if (!server.empty() && !line.starts_with("#     ")) break;
    if (line.starts_with("#   modbus:") || !server.empty()) server += line.substr(2) + "\n";
  }
  return server;
}

TEST(PointConfiguration, of_a_Modbus_server_in_the_reference_is_read_whole) {
  const auto read = parse_configuration(with(kAsked + server_of_reference()), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto* points = std::get_if<linux_hal::RegisterClientConfiguration>(&read->sensor);
  ASSERT_NE(points, nullptr);
  EXPECT_EQ(points->address, "192.168.5.30");
  EXPECT_EQ(points->port, 502);
  ASSERT_EQ(points->profile.registers.size(), 3U);
  EXPECT_EQ(points->profile.registers[1], 2);
  EXPECT_EQ(points->profile.counter, 6);
  EXPECT_EQ(points->profile.format, modbus::Format::kF32);
  EXPECT_DOUBLE_EQ(points->profile.metres_a_step, 1e-3);
  EXPECT_EQ(points->poll_period, std::chrono::milliseconds(50));
  EXPECT_EQ(points->answer_timeout, std::chrono::milliseconds(200));
  EXPECT_EQ(read->controller.sensor.measures, controller::Measures::kPoints);
}

TEST(PointConfiguration, of_a_Modbus_server_that_cannot_be_is_refused_in_its_place) {
  const std::string least =
      std::string(kAsked) + "  modbus: {address: 10.0.0.3, x: 0, y: 2, z: 4, metres_a_step: 1.0, ";
  const auto read = parse_configuration(with(least + "update_period_ms: 100}\n"), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  expect_refused(least + "counter: 6, update_period_ms: 100}\n", "when a point is new");
  expect_refused(least + "unit: 1}\n", "when a point is new");
  expect_refused(least + "counter: 5}\n", "the sensor profile contradicts itself");
  expect_refused(least + "counter: 200}\n", "the sensor profile contradicts itself");
  expect_refused(least + "counter: 6, unit: 0}\n", "unit");
  expect_refused(least + "counter: 6, format: f64}\n", "f32");
  expect_refused(least + "counter: 6, words: swapped}\n", "low-first");
  expect_refused(least + "counter: 6, poll_period_ms: 501}\n", "two readings");
  expect_refused(least + "counter: 6, answer_timeout_ms: 11000}\n", "no sensor answers");
  expect_refused(least + "update_period_ms: 501}\n", "two readings");
  expect_refused(least + "update_period_ms: 1, update_period_s: 1}\n", "update_period");
  expect_refused(least + "update_period_ms: often}\n", "update_period_ms");
  expect_refused(least + "update_period_ms: 300}\n", "update_period: 0.3");
  expect_refused(least + "counter: 6}\n  silent_after_ms: 90\n", "silent_after");
  expect_refused(least + "counter: 6}\n  stale_after_ms: 90\n", "stale_after");
  expect_refused(least + "update_period_ms: 100}\n  stale_after_ms: 500\n", "nothing counts them");
  expect_refused(least + "counter: 6}\n  port: 7047\n", "port beside modbus");
  expect_refused(
      std::string(kAsked) + "  modbus: {x: 0, y: 2, z: 4, metres_a_step: 1, counter: 6}\n",
      "address");
  expect_refused(std::string(kAsked) +
                     "  modbus: {address: tracker, x: 0, y: 2, z: 4, "
                     "metres_a_step: 1, counter: 6}\n",
                 "in numbers");
  expect_refused(std::string(kAsked) +
                     "  modbus: {address: 10.0.0.3, x: 0, y: 2, z: 4, "
                     "metres_a_step: 1000, counter: 6}\n",
                 "millimetres as metres");
}

TEST(LengthConfiguration, of_the_reference_is_read_whole) {
  const auto read = parse_configuration(with(of_reference("lengths")), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto* lengths = std::get_if<linux_hal::LineServerConfiguration>(&read->sensor);
  ASSERT_NE(lengths, nullptr);
  EXPECT_EQ(lengths->port, 7048);
  const controller::Sensor& sensor = read->controller.sensor;
  EXPECT_EQ(sensor.measures, controller::Measures::kPoints);
  ASSERT_EQ(sensor.receivers.p_S.size(), 4U);
  EXPECT_DOUBLE_EQ(sensor.receivers.p_S[3].z(), 0.3);
  EXPECT_DOUBLE_EQ(sensor.receivers.range_sigma_m, 1e-4);
  EXPECT_DOUBLE_EQ(sensor.receivers.facing_S.z(), 1);
  ASSERT_EQ(read->length_offsets_m.size(), 4U);
  EXPECT_DOUBLE_EQ(read->length_offsets_m[0], 0.0355);
  EXPECT_DOUBLE_EQ(read->length_offsets_m[1], 0);
}

constexpr const char* kWires =
    "lengths:\n  target: {x_mm: 150, y_mm: 0, z_mm: 50}\n  sigma_mm: 0.1\n  facing: [0, 0, 1]\n";
constexpr const char* kAnchors =
    "  anchors: [{x_m: 0, y_m: 0, z_m: 0}, {x_m: 2, y_m: 0, z_m: 0}, {x_m: 0, y_m: 2, z_m: 0}]\n";

TEST(LengthConfiguration, of_a_Modbus_server_is_read_whole) {
  const std::string text = std::string(kWires) + kAnchors +
                           "  modbus: {address: 10.0.0.3, registers: [8, 10, 12], "
                           "metres_a_step: 0.001, update_period_ms: 100}\n";
  const auto read = parse_configuration(with(text), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto* lengths = std::get_if<linux_hal::RegisterClientConfiguration>(&read->sensor);
  ASSERT_NE(lengths, nullptr);
  ASSERT_EQ(lengths->profile.registers.size(), 3U);
  EXPECT_EQ(lengths->profile.registers[2], 12);
}

TEST(LengthConfiguration, that_cannot_be_is_refused_in_its_place) {
  const std::string wires = kWires;
  const std::string told = wires + "  port: 7048\n";
  expect_refused(told, "anchors");
  expect_refused(wires + kAnchors, "port");
  const auto with_anchors = [&](const std::string& list) {
    return told + "  anchors: [" + list + "]\n";
  };
  const std::string two = "{x_m: 0, y_m: 0, z_m: 0}, {x_m: 2, y_m: 0, z_m: 0}";
  expect_refused(with_anchors(two), "3 to 8");
  expect_refused(with_anchors(two + ", {x_m: 4, y_m: 0, z_m: 0}"), "on one line");
  expect_refused(with_anchors(two + ", {x_m: 0, y_m: 2}"), "z");
  expect_refused(with_anchors(two + ", {x_m: 0, y_m: 2000, z_m: 0}"), "millimetres as metres");
  expect_refused(with_anchors(two + ", {x_m: 0, y_m: 2, z_m: 0, offset_m: 300}"),
                 "millimetres as metres");
  expect_refused(with_anchors(two + ", {x_m: 0, y_m: 2, z_m: 0, gain: 1}"), "gain");
  std::string nowhere = told + kAnchors;
  const std::string facing = "  facing: [0, 0, 1]\n";
  nowhere.erase(nowhere.find(facing), facing.size());
  expect_refused(nowhere, "facing");
  const std::string asked =
      wires + kAnchors + "  modbus: {address: 10.0.0.3, metres_a_step: 0.001, counter: 6, ";
  expect_refused(asked + "x: 0, y: 2, z: 4}\n", "x");
  expect_refused(asked + "registers: [0, 2]}\n", "registers");
  expect_refused(asked + "registers: [0, 2, 5]}\n", "lengths and counter in registers");
  expect_refused(asked + "registers: [0, 2, 65536]}\n", "registers");
}

TEST(LengthConfiguration, that_the_controller_refuses_is_refused_in_its_place) {
  const std::string text =
      with(std::string(kWires) + kAnchors + "  port: 7048\n  reading_timeout_s: 61\n");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  const auto before = text.substr(0, text.find("reading_timeout_s"));
  EXPECT_EQ(test::failure_of(read).line, 1 + std::ranges::count(before, '\n'))
      << tool::render(test::failure_of(read));
}

TEST(LengthConfiguration, that_differs_anywhere_has_another_fingerprint) {
  const auto crc_of = [](std::string text, const std::string& old, const std::string& put) {
    text.replace(text.find(old), old.size(), put);
    const auto read = parse_configuration(with(text), "cabinet.yaml");
    EXPECT_TRUE(read) << put;
    return read ? read->controller.sensor.settings_crc : 0;
  };
  const std::string text = of_reference("lengths");
  const std::uint32_t crc = crc_of(text, "7048", "7048");
  EXPECT_EQ(crc_of(text, "# 1 sigma", "# one sigma"), crc) << "a remark";
  EXPECT_NE(crc_of(text, "offset_mm: 35.5", "offset_mm: 35.6"), crc);
  EXPECT_NE(crc_of(text, "y_mm: 2000", "y_mm: 2001"), crc);
}

std::filesystem::path guide_path() {
  return std::filesystem::path(ARMSIG_REFERENCE).parent_path() / "../../docs/sensors.md";
}

// The indented block of the guide that begins with `key`, and its line that begins with `word`.
std::string of_guide(const std::string& key) {
  std::ifstream file(guide_path());
  std::string block;
  for (std::string line; std::getline(file, line);) {
    if (block.empty() && line != "    " + key + ":") continue;
    if (!line.starts_with("    ")) break;
    block += line.substr(4) + "\n";
  }
  return block;
}
std::string line_of_guide(const std::string& word) {
  std::ifstream file(guide_path());
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("    " + word + " ")) return line.substr(4);
  }
  return {};
}

TEST(PointConfiguration, of_the_guide_is_taken_with_its_line) {
  const auto read = parse_configuration(with(of_guide("points")), "sensors.md");
  EXPECT_TRUE(read) << tool::render(read.error());
  EXPECT_TRUE(linux_hal::PointLine::parse(line_of_guide("point")));
}

TEST(LengthConfiguration, of_the_guide_is_taken_and_its_lengths_meet) {
  const auto read = parse_configuration(with(of_guide("lengths")), "sensors.md");
  ASSERT_TRUE(read) << tool::render(read.error());
  const auto line = linux_hal::LengthLine::parse(line_of_guide("lengths"));
  ASSERT_TRUE(line);
  ASSERT_EQ(line->lengths_m.size(), 4U);
  const Vector3 p_S(0.9, 0.7, 0.63);
  for (std::size_t i = 0; i < 4; ++i) {
    const double length_m = line->lengths_m[i].value_or(0) + read->length_offsets_m[i];
    EXPECT_NEAR((p_S - read->controller.sensor.receivers.p_S[i]).norm(), length_m, 0.05e-3) << i;
  }
}

TEST(LengthConfiguration, beside_points_is_refused) {
  expect_refused(std::string(kLeast) + kWires + kAnchors + "  port: 7048\n",
                 "lengths beside points");
}

TEST(PointConfiguration, beside_a_sensor_is_refused) {
  std::ifstream file(ARMSIG_REFERENCE);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto read = parse_configuration(text + "\n" + kLeast, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("points beside sensor"), std::string::npos);
}

TEST(PointConfiguration, of_neither_leaves_signatures_to_others) {
  const auto read = parse_configuration(with(""), "cabinet.yaml");
  ASSERT_TRUE(read) << tool::render(read.error());
  EXPECT_TRUE(std::holds_alternative<std::monostate>(read->sensor));
  EXPECT_EQ(read->controller.sensor.measures, controller::Measures::kNothing);
}

TEST(PointConfiguration, lets_a_second_person_confirm_where_it_says_so) {
  const auto needs = [](const std::string& told) {
    std::string text = with("");
    const std::string reference = "accept_sent: measured ";
    text.replace(text.find(reference), reference.size(), told);
    return parse_configuration(text, "cabinet.yaml");
  };
  EXPECT_EQ(needs("accept_sent: confirmed ")->controller.sent_needs,
            controller::SentNeeds::kConfirmed);
  EXPECT_EQ(needs("# ")->controller.sent_needs, controller::SentNeeds::kMeasured);
  EXPECT_FALSE(needs("accept_sent: anybody "));
}

TEST(PointConfiguration, of_neither_has_no_check_by_schedule) {
  std::string text = with("");
  const std::string never = "every_hours: 0 ";
  text.replace(text.find(never), never.size(), "every_hours: 8 ");
  const auto read = parse_configuration(text, "cabinet.yaml");
  ASSERT_FALSE(read);
  EXPECT_NE(tool::render(test::failure_of(read)).find("no sensor is configured"), std::string::npos)
      << tool::render(read.error());
}

}  // namespace
}  // namespace armsig::daemon
