// SPDX-License-Identifier: MIT
// The settings of docs/sensors.md for sensors that are sold, each read from a server with the
// registers that the sensor's documents describe. Ranges are worked out by hand from the registers.
#include <chrono>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/measurement/speed_of_sound.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/pty_server.hpp"
#include "host_tests/support/register_server.hpp"

namespace armsig::daemon {
namespace {

using Registers = test::RegisterServer::Registers;

std::string text_of(const char* path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// What stands in YAML below each heading of the third level.
std::map<std::string, std::string> settings_of_guide() {
  std::map<std::string, std::string> settings;
  std::istringstream guide(text_of(ARMSIG_GUIDE));
  std::string heading;
  bool inside = false;
  for (std::string line; std::getline(guide, line);) {
    if (line.starts_with("### ")) heading = line.substr(4);
    if (line.starts_with("```")) {
      inside = line == "```yaml";
    } else if (inside) {
      settings[heading] += "  " + line + "\n";
    }
  }
  return settings;
}

// The reference, its sensor with four receivers and these settings, on this device.
std::string configuration_with(const std::string& settings, const std::string& device) {
  std::string text = text_of(ARMSIG_REFERENCE);
  text = text.substr(0, text.find("\ngrid:") + 1);
  const auto cut = [&](const std::string& from, const std::string& to, const std::string& instead) {
    const std::size_t begin = text.find(from);
    text.replace(begin, text.find(to, begin) - begin, instead);
  };
  cut("    - {x_mm: -500,  y_mm: -500,  z_mm: 800}", "  facing:", "");
  cut("  modbus:", "\nmotion:", settings);
  if (settings.find("reading_timeout_ms") != std::string::npos) {
    cut("  reading_timeout_ms: 1000", "\n", "#");
  }
  cut("/dev/ttyUSB0", "\n", device);
  return text;
}

// Units with registers, by the settings of the guide.
class SoldSensor {
 public:
  SoldSensor(const std::string& name, std::uint8_t first_unit, std::uint8_t function,
             const std::vector<Registers>& units) {
    for (std::size_t j = 0; j < units.size(); ++j) {
      server_.units[static_cast<std::uint8_t>(first_unit + j)].functions[function] = units[j];
    }
    const std::string settings = settings_of_guide()[name];
    EXPECT_FALSE(settings.empty()) << name << " is not in the guide";
    const auto read = parse_configuration(configuration_with(settings, line_.device), name);
    if (!read) {
      ADD_FAILURE() << tool::render(read.error());
      return;
    }
    auto started = linux_hal::RtuRangeSensor::start(
        std::get<linux_hal::RtuRangeSensorConfiguration>(read->sensor));
    if (started) sensor_ = std::move(*started);
  }

  hal::RangeReading reading() {
    for (int i = 0; sensor_ && i < 3000; ++i) {
      const auto polled = sensor_->poll(linux_hal::monotonic_now());
      if (!polled) {
        ADD_FAILURE() << describe(polled.error());
        return {};
      }
      if (*polled) return **polled;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    ADD_FAILURE() << "no reading";
    return {};
  }

 private:
  std::mutex mutex_;
  test::RegisterServer server_;
  test::PtyServer line_{[this](const auto& request) {
    const std::lock_guard lock(mutex_);
    return server_.answer(request);
  }};
  std::unique_ptr<linux_hal::RtuRangeSensor> sensor_;
};

// Metres, as the controller makes them of the times by the air of the reading; 0: not heard.
std::vector<double> ranges_of(const hal::RangeReading& reading) {
  const auto speed = measurement::speed_of_sound(reading.air_celsius);
  std::vector<double> ranges;
  for (const hal::ReceiverReading& receiver : reading.receivers) {
    ranges.push_back(receiver.valid && speed ? receiver.flight_s * *speed : 0);
  }
  return ranges;
}

void expect_ranges(const hal::RangeReading& reading, const std::vector<double>& metres) {
  const std::vector<double> ranges = ranges_of(reading);
  ASSERT_EQ(ranges.size(), metres.size());
  for (std::size_t j = 0; j < metres.size(); ++j) EXPECT_NEAR(ranges[j], metres[j], 1e-12) << j;
}

TEST(SoldSensors, are_four_in_the_guide) { EXPECT_EQ(settings_of_guide().size(), 4U); }

TEST(SoldSensors, dfrobot_urm14) {
  SoldSensor sensor(
      "DFRobot URM14", 12, 3,
      {{{5, 12'345}, {6, 225}}, {{5, 2'001}}, {{5, 0xFFFF}}, {{5, 14'999}, {6, 999}}});
  const hal::RangeReading reading = sensor.reading();
  expect_ranges(reading, {1.2345, 0.2001, 0, 1.4999});
  EXPECT_DOUBLE_EQ(reading.air_celsius, 22.5);
}

TEST(SoldSensors, seeed_101991042) {
  SoldSensor sensor("Seeed SenseCAP 101991042", 1, 3,
                    {{{256, 1'111}, {257, 1'803}, {258, 0xFFF6}},
                     {{256, 2'222}, {257, 455}, {258, 210}},
                     {{256, 3'333}, {257, 0}, {258, 210}},
                     {{256, 4'444}, {257, 4'999}, {258, 210}}});
  const hal::RangeReading reading = sensor.reading();
  expect_ranges(reading, {1.803, 0.455, 0, 4.999});
  EXPECT_DOUBLE_EQ(reading.air_celsius, -1.0);
}

TEST(SoldSensors, apg_mnu_is) {
  SoldSensor sensor("APG MNU IS", 1, 4,
                    {{{299, 1'234}, {300, 0}, {301, 23}, {302, 7}},
                     {{299, 10'364}, {300, 0}, {301, 24}},
                     {{299, 10'365}, {300, 0}, {301, 24}},
                     {{299, 0}, {300, 0}, {301, 24}}});
  const hal::RangeReading reading = sensor.reading();
  expect_ranges(reading, {1.234, 10.364, 0, 0});
  EXPECT_DOUBLE_EQ(reading.air_celsius, 23.0);
}

// 812.25 and 1999.125 mm at 0 degrees Celsius, 23.75 degrees: by struct.pack of Python.
TEST(SoldSensors, sommer_ush_9) {
  SoldSensor sensor("Sommer USH-9", 1, 4,
                    {{{40, 0x444B}, {41, 0x1000}, {42, 0x41BE}, {43, 0x0000}},
                     {{40, 0x44F9}, {41, 0xE400}},
                     {{40, 0x7FC0}, {41, 0x0000}},
                     {{40, 0xFF80}, {41, 0x0000}}});
  const hal::RangeReading reading = sensor.reading();
  ASSERT_EQ(reading.receivers.size(), 4U);
  EXPECT_TRUE(reading.receivers[0].valid);
  EXPECT_NEAR(reading.receivers[0].flight_s, 0.002451705402958044, 1e-15);
  EXPECT_TRUE(reading.receivers[1].valid);
  EXPECT_NEAR(reading.receivers[1].flight_s, 0.006034183519468759, 1e-15);
  EXPECT_FALSE(reading.receivers[2].valid);
  EXPECT_FALSE(reading.receivers[3].valid);
  EXPECT_EQ(reading.air_celsius, 23.75);
}

}  // namespace
}  // namespace armsig::daemon
