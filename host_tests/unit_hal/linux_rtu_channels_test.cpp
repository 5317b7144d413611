// SPDX-License-Identifier: MIT
// Several units on one pseudo-terminal, read by libmodbus.
#include <chrono>
#include <mutex>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/steady_clock.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/pty_server.hpp"
#include "host_tests/support/register_server.hpp"

namespace armsig::linux_hal {
namespace {

using modbus::Format;
using std::chrono::milliseconds;

// Units 3, 4 and 5: a time of flight in microseconds, as a number with a point. Unit 3 knows the
// air.
class ThreeUnits {
 public:
  ThreeUnits() {
    for (std::uint8_t unit = 3; unit <= 5; ++unit) {
      profile.channels.push_back(
          {.field = {.unit = unit, .first = 300, .format = Format::kF32, .step = 1e-6}});
      // 1234.5
      server.units[unit].functions[4] = {{300, 0x449A}, {301, 0x5000}};
    }
    profile.air =
        modbus::Field{.unit = 3, .function = 3, .first = 0, .format = Format::kI16, .step = 0.01};
    server.units[3].functions[3] = {{0, static_cast<std::uint16_t>(-150)}};
    profile.update_period = milliseconds(20);
  }

  RtuRangeSensorConfiguration configuration() const {
    return {.device = line.device,
            .channels = profile,
            .poll_period = milliseconds(5),
            .answer_timeout = milliseconds(50),
            .freshness = {.silent_after = milliseconds(400), .stale_after = milliseconds(400)}};
  }

  template <typename Change>
  void change(Change&& change) {
    const std::lock_guard lock(mutex_);
    change(server.units);
  }

  modbus::ChannelProfile profile;

 private:
  std::mutex mutex_;
  test::RegisterServer server;

 public:
  test::PtyServer line{[this](const auto& request) {
    const std::lock_guard lock(mutex_);
    return server.answer(request);
  }};
};

Result<hal::RangeReading> next(RtuRangeSensor& sensor) {
  for (int i = 0; i < 3000; ++i) {
    const auto polled = sensor.poll(monotonic_now());
    if (!polled) return std::unexpected(polled.error());
    if (*polled) return **polled;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return std::unexpected(Error::kNotConverged);
}

TEST(RtuChannels, of_several_units_are_one_reading) {
  ThreeUnits three;
  const auto sensor = RtuRangeSensor::start(three.configuration());
  ASSERT_TRUE(sensor);
  const auto first = next(**sensor);
  const hal::Instant came_at = monotonic_now();
  const auto second = next(**sensor);
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->sequence, second->sequence);
  ASSERT_EQ(first->receivers.size(), 3U);
  for (const hal::ReceiverReading& receiver : first->receivers) {
    EXPECT_TRUE(receiver.valid);
    EXPECT_DOUBLE_EQ(receiver.flight_s, 1234.5e-6);
  }
  EXPECT_DOUBLE_EQ(first->air_celsius, -1.5);
  EXPECT_GE(second->at - first->at, milliseconds(20)) << "as seldom as the sensor measures";
  EXPECT_LE(first->at, came_at - milliseconds(20)) << "as old as its oldest value may be";
}

TEST(RtuChannels, leave_out_a_unit_that_is_silent_refuses_or_answers_for_another) {
  ThreeUnits three;
  const auto sensor = RtuRangeSensor::start(three.configuration());
  ASSERT_TRUE(sensor);
  using Unit = test::RegisterServer::Unit;
  const std::vector<void (*)(Unit&)> faults{
      [](Unit& unit) { unit.silent = true; }, [](Unit& unit) { unit.exception = 6; },
      [](Unit& unit) { unit.answers_as = 5; }, [](Unit& unit) { unit.short_of_one = true; }};
  const std::vector<Error> errors{Error::kSensorSilent, Error::kSensorException,
                                  Error::kSensorWrongUnit, Error::kSensorMalformed};
  EXPECT_TRUE(next(**sensor) && !(*sensor)->failing_unit());
  for (std::size_t k = 0; k < faults.size(); ++k) {
    three.change([&](auto& units) { faults[k](units[4]); });
    Result<hal::RangeReading> reading = next(**sensor);
    for (int i = 0; i < 20 && reading && reading->receivers[1].valid; ++i) reading = next(**sensor);
    ASSERT_TRUE(reading) << k;
    EXPECT_TRUE(reading->receivers[0].valid) << k;
    EXPECT_FALSE(reading->receivers[1].valid) << k;
    EXPECT_TRUE(reading->receivers[2].valid) << k;
    const auto failing = (*sensor)->failing_unit();
    ASSERT_TRUE(failing) << k;
    EXPECT_EQ(failing->unit, 4) << k;
    EXPECT_EQ(failing->error, errors[k]) << k;
    three.change(
        [](auto& units) { units[4] = Unit{.functions = {{4, {{300, 0x449A}, {301, 0x5000}}}}}; });
    for (int i = 0; i < 20 && reading && !reading->receivers[1].valid; ++i) {
      reading = next(**sensor);
    }
    ASSERT_TRUE(reading) << k;
    EXPECT_TRUE(reading->receivers[1].valid) << k;
  }
}

TEST(RtuChannels, that_are_no_numbers_are_not_heard) {
  ThreeUnits three;
  three.change([](auto& units) {
    units[3].functions[4][300] = 0x7FC0;  // not a number
    units[4].functions[4][300] = 0x7F80;  // infinite
    units[4].functions[4][301] = 0;
    units[5].functions[4][300] = 0xC49A;  // -1234.5
  });
  const auto sensor = RtuRangeSensor::start(three.configuration());
  ASSERT_TRUE(sensor);
  const auto reading = next(**sensor);
  ASSERT_TRUE(reading);
  for (const hal::ReceiverReading& receiver : reading->receivers) {
    EXPECT_FALSE(receiver.valid);
    EXPECT_EQ(receiver.flight_s, 0);
  }
}

TEST(RtuChannels, of_units_that_are_all_silent_are_a_silent_sensor) {
  ThreeUnits three;
  three.change([](auto& units) {
    for (auto& [number, unit] : units) unit.silent = true;
  });
  const auto sensor = RtuRangeSensor::start(three.configuration());
  ASSERT_TRUE(sensor);
  EXPECT_EQ(test::failure_of(next(**sensor)), Error::kSensorSilent);
}

TEST(RtuChannels, that_contradict_themselves_are_refused) {
  RtuRangeSensorConfiguration configuration{.device = "/dev/null",
                                            .channels = modbus::ChannelProfile{}};
  EXPECT_EQ(test::failure_of(RtuRangeSensor::start(configuration)), Error::kProfileInvalid);
}

}  // namespace
}  // namespace armsig::linux_hal
