// SPDX-License-Identifier: MIT
#include <filesystem>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "firmware/formats/sensor_file.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "host_tests/support/temporary.hpp"

namespace armsig::tool {
namespace {

const std::string kReceivers =
    "receivers:\n"
    "  - {x_mm: 0, y_mm: 0, z_mm: 0}\n"
    "  - {x_mm: 1500, y_mm: 0, z_mm: 0}\n"
    "  - {x_mm: 0, y_m: 1.5, z_mm: 0}\n";

std::string sensor_with(const std::string& receivers, const std::string& rest = "") {
  return "armsig: sensor/1\nname: frame\n" + receivers + "range_sigma_mm: 0.2\npath: one-way\n" +
         rest;
}

std::string message_of(const std::string& text) {
  const auto sensor = parse_sensor(text, "R.yaml");
  return sensor ? "read" : render(sensor.error());
}

TEST(SensorFile, is_given_in_si) {
  const auto sensor =
      parse_sensor(sensor_with(kReceivers, "facing: [0, 0, 2]\ncalibrated_at_c: 20\n"), "R.yaml");
  ASSERT_TRUE(sensor) << render(sensor.error());
  EXPECT_EQ(sensor->name, "frame");
  ASSERT_EQ(sensor->receivers_S.size(), 3U);
  EXPECT_EQ(sensor->receivers_S[1], Vector3(1.5, 0, 0));
  EXPECT_EQ(sensor->receivers_S[2], Vector3(0, 1.5, 0));
  EXPECT_DOUBLE_EQ(sensor->range_sigma_m, 2e-4);
  EXPECT_FALSE(sensor->echo);
  EXPECT_EQ(*sensor->facing_S, Vector3(0, 0, 1));
  EXPECT_EQ(sensor->calibrated_at_c, 20);
}

TEST(SensorFile, leaves_facing_and_calibration_open) {
  const auto sensor = parse_sensor(sensor_with(kReceivers), "R.yaml");
  ASSERT_TRUE(sensor) << render(sensor.error());
  EXPECT_FALSE(sensor->facing_S);
  EXPECT_FALSE(sensor->calibrated_at_c);
}

TEST(SensorFile, refuses_collinear_receivers) {
  EXPECT_EQ(message_of(sensor_with("receivers: [{x_m: 0, y_m: 0, z_m: 0}, {x_m: 1, y_m: 1, z_m: 1},"
                                   " {x_m: 3, y_m: 3, z_m: 3}]\n")),
            "R.yaml:3:12: the receivers stand on one line; expected at least three that span a "
            "plane");
  EXPECT_EQ(message_of(sensor_with("receivers: [{x_m: 1, y_m: 0, z_m: 0}, {x_m: 1, y_m: 0, z_m: 0},"
                                   " {x_m: 1, y_m: 0, z_m: 0}]\n")),
            "R.yaml:3:12: the receivers stand on one line; expected at least three that span a "
            "plane");
}

TEST(SensorFile, refuses_fewer_than_three_receivers) {
  EXPECT_EQ(message_of(sensor_with("receivers: [{x_m: 0, y_m: 0, z_m: 0}]\n")),
            "R.yaml:3:12: receivers: 1 item; expected a list of 3 to 16 items");
}

TEST(SensorFile, refuses_a_receiver_without_unit) {
  EXPECT_EQ(message_of(sensor_with("receivers:\n  - {x: 0, y_m: 0, z_m: 0}\n  - {}\n  - {}\n")),
            "R.yaml:4:6: key \"x\" of receiver 1 has no unit; expected x_mm or x_m");
}

TEST(SensorFile, refuses_a_sigma_that_is_not_positive) {
  std::string text = sensor_with(kReceivers);
  text.replace(text.find("0.2"), 3, "-.2");
  EXPECT_EQ(message_of(text),
            "R.yaml:7:17: range_sigma_mm: -.2 is not positive; expected a standard deviation "
            "above 0");
}

TEST(SensorFile, refuses_an_unknown_path) {
  std::string text = sensor_with(kReceivers);
  text.replace(text.find("one-way"), 7, "two-way");
  EXPECT_EQ(message_of(text), "R.yaml:8:7: path: \"two-way\"; expected one-way or echo");
}

TEST(SensorFile, refuses_a_direction_without_length) {
  EXPECT_EQ(message_of(sensor_with(kReceivers, "facing: [0, 0, 0]\n")),
            "R.yaml:9:9: facing: a vector of no length; expected a direction");
}

TEST(SensorFile, refuses_a_temperature_below_absolute_zero) {
  EXPECT_EQ(message_of(sensor_with(kReceivers, "calibrated_at_c: -300\n")),
            "R.yaml:9:18: calibrated_at_c: -300; expected a temperature above absolute zero");
}

TEST(SensorFile, refuses_a_missing_key) {
  EXPECT_EQ(message_of("armsig: sensor/1\nname: x\n" + kReceivers + "path: echo\n"),
            "R.yaml:1:1: the sensor has no key \"range_sigma\"; expected range_sigma_mm or "
            "range_sigma_m");
}

TEST(SensorFile, reads_back_as_written) {
  const std::string path = test::temporary("sensor.yaml");
  SensorDescription written{"echo frame", {}, 1e-4, true, Vector3(0, 0.6, 0.8), 21.5};
  written.receivers_S = {Vector3(1.0 / 3, 0, 0), Vector3(0, 1.0 / 7, 0), Vector3(0, 0, -1e-3)};
  ASSERT_TRUE(write_sensor_file(path, written));
  const auto read = read_sensor_file(path);
  ASSERT_TRUE(read) << render(read.error());
  EXPECT_EQ(read->name, written.name);
  EXPECT_EQ(read->receivers_S, written.receivers_S);
  EXPECT_EQ(read->range_sigma_m, 1e-4);
  EXPECT_TRUE(read->echo);
  EXPECT_EQ(*read->facing_S, *written.facing_S);
  EXPECT_EQ(read->calibrated_at_c, 21.5);
  std::filesystem::remove(path);
}

TEST(DirectionsOfFiles, have_length_1_and_come_back_as_the_same_bits) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const double size : {1e-300, 1e-9, 1.0, 3.0, 1e300}) {
    for (int k = 0; k < 1000; ++k) {
      const Vector3 once = direction_of(size * Vector3(any(random), any(random), any(random)));
      EXPECT_NEAR(once.norm(), 1, 1e-15);
      EXPECT_EQ(direction_of(once), once);
    }
  }
  EXPECT_EQ(direction_of(Vector3::Zero()), Vector3::Zero());
  EXPECT_GT((direction_of({0, 0, 1 + 1e-12}) - Vector3(0, 0, 1 + 1e-12)).norm(), 0);
}

TEST(SensorFile, refuses_to_write_what_it_would_not_read) {
  EXPECT_FALSE(write_sensor_file(test::temporary("never.yaml"), {}));
}

}  // namespace
}  // namespace armsig::tool
