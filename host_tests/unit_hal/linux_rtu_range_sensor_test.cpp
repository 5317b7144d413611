// SPDX-License-Identifier: MIT
// libmodbus on one end of a pseudo-terminal, a scripted sensor on the other.
#include <time.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/linux/rtu_range_sensor.hpp"
#include "hal/linux/steady_clock.hpp"
#include "hal/modbus/rtu.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/pty_server.hpp"
#include "host_tests/support/scripted_line.hpp"

namespace armsig::linux_hal {
namespace {

using std::chrono::milliseconds;
using test::bytes;

std::vector<std::uint8_t> with_crc(std::vector<std::uint8_t> body) {
  const std::uint16_t crc = modbus::crc16(body);
  body.push_back(static_cast<std::uint8_t>(crc & 0xFF));
  body.push_back(static_cast<std::uint8_t>(crc >> 8));
  return body;
}

// There before the server's thread, and after it.
struct FirstRequest {
  std::vector<std::uint8_t> first_request;  // read it after stop()
};

// Answers each request with what `script` makes of the number of the request.
class PtySensor : public FirstRequest, public test::PtyServer {
 public:
  using Script = std::function<std::vector<std::uint8_t>(unsigned)>;

  explicit PtySensor(Script script)
      : PtyServer([this, script = std::move(script), number = 0U](const auto& request) mutable {
          if (number == 0) first_request = request;
          return script(number++);
        }) {}
  ~PtySensor() { stop(); }
};

std::vector<std::uint8_t> answer(std::uint8_t unit, std::uint8_t sequence) {
  std::vector<std::uint8_t> body = bytes("010418000F000700E600040016E3600016E3610016E3620016E363");
  body[0] = unit;
  body[6] = sequence;
  return with_crc(body);
}

RtuRangeSensorConfiguration configuration_for(const PtySensor& line) {
  return {.device = line.device,
          .poll_period = milliseconds(5),
          .answer_timeout = milliseconds(50),
          .freshness = {.silent_after = milliseconds(300), .stale_after = milliseconds(300)}};
}

// The first thing but "nothing yet" that poll() says.
Result<hal::RangeReading> next(RtuRangeSensor& sensor) {
  for (int i = 0; i < 2000; ++i) {
    auto polled = sensor.poll(monotonic_now());
    if (!polled) return std::unexpected(polled.error());
    if (*polled) return **polled;
    std::this_thread::sleep_for(milliseconds(1));
  }
  return std::unexpected(Error::kNotConverged);
}

TEST(RtuRangeSensor, reads_the_default_map_over_a_real_terminal) {
  PtySensor line([](unsigned number) { return answer(1, static_cast<std::uint8_t>(number)); });
  {
    const auto sensor = RtuRangeSensor::start(configuration_for(line));
    ASSERT_TRUE(sensor);
    const auto first = next(**sensor);
    const auto second = next(**sensor);
    ASSERT_TRUE(first && second);
    EXPECT_EQ(second->sequence, first->sequence + 1);
    EXPECT_EQ(first->receivers.size(), 4U);
    EXPECT_DOUBLE_EQ(first->receivers[3].flight_s, 1500003e-9);
    EXPECT_DOUBLE_EQ(first->air_celsius, 23.0);
    EXPECT_LT(first->at, second->at);
  }
  line.stop();
  EXPECT_EQ(line.first_request, bytes("01040000000CF00F"));
}

TEST(RtuRangeSensor, tells_each_wrong_answer_and_recovers) {
  struct Wrong {
    std::vector<std::uint8_t> bytes;
    Error error;
  };
  std::vector<std::uint8_t> bad_crc = answer(1, 9);
  bad_crc.back() ^= 1;
  for (const Wrong& wrong :
       {Wrong{bad_crc, Error::kSensorBadCrc}, Wrong{answer(2, 9), Error::kSensorWrongUnit},
        Wrong{bytes("018402C2C1"), Error::kSensorException}}) {
    PtySensor line([&](unsigned number) {
      return number == 0 ? wrong.bytes : answer(1, static_cast<std::uint8_t>(number));
    });
    const auto sensor = RtuRangeSensor::start(configuration_for(line));
    ASSERT_TRUE(sensor);
    EXPECT_EQ(test::failure_of(next(**sensor)), wrong.error);
    if (wrong.error == Error::kSensorException) {
      EXPECT_EQ((*sensor)->exception_code(), 2);
      EXPECT_EQ((*sensor)->words(wrong.error), "illegal data address");
    }
    EXPECT_TRUE(next(**sensor));
  }
}

TEST(RtuRangeSensor, a_line_that_echoes_requests_is_told_and_what_to_look_for) {
  PtySensor line([](unsigned number) {
    auto echoed = bytes("01040000000CF00F");
    const auto real = answer(1, static_cast<std::uint8_t>(number));
    echoed.insert(echoed.end(), real.begin(), real.end());
    return echoed;
  });
  RtuRangeSensorConfiguration patient = configuration_for(line);
  patient.answer_timeout = milliseconds(1000);  // a busy machine is no silent sensor
  patient.freshness = {.silent_after = milliseconds(5000), .stale_after = milliseconds(5000)};
  const auto sensor = RtuRangeSensor::start(patient);
  ASSERT_TRUE(sensor);
  for (int i = 0; i < 3; ++i) {
    const auto polled = next(**sensor);
    ASSERT_FALSE(polled) << "a wrong reading";
    ASSERT_EQ(test::failure_of(polled), Error::kSensorBadCrc);
  }
  EXPECT_NE((*sensor)->words(Error::kSensorBadCrc).find("echoes"), std::string_view::npos);
}

TEST(RtuRangeSensor, a_sensor_that_does_not_answer_is_silent) {
  PtySensor line([](unsigned) { return std::vector<std::uint8_t>(); });
  const auto sensor = RtuRangeSensor::start(configuration_for(line));
  ASSERT_TRUE(sensor);
  EXPECT_EQ(test::failure_of(next(**sensor)), Error::kSensorSilent);
}

// A byte that the line lost is waited for as long as a whole answer may take, and no longer.
TEST(RtuRangeSensor, an_answer_that_lost_a_byte_costs_the_time_of_an_answer_alone) {
  PtySensor line([](unsigned number) {
    auto bytes = answer(1, static_cast<std::uint8_t>(number));
    if (number == 0) bytes.pop_back();
    return bytes;
  });
  const RtuRangeSensorConfiguration configuration = configuration_for(line);
  const hal::Instant begin = monotonic_now();
  const auto sensor = RtuRangeSensor::start(configuration);
  ASSERT_TRUE(sensor);
  const auto reading = next(**sensor);
  ASSERT_TRUE(reading) << "it is no silent sensor";
  EXPECT_EQ(reading->sequence, 1U);
  EXPECT_GE(monotonic_now() - begin, configuration.answer_timeout);
  EXPECT_LT(monotonic_now() - begin, milliseconds(450));
}

TEST(RtuRangeSensor, a_sequence_that_stands_still_is_stale) {
  PtySensor line([](unsigned) { return answer(1, 7); });
  const auto sensor = RtuRangeSensor::start(configuration_for(line));
  ASSERT_TRUE(sensor);
  EXPECT_TRUE(next(**sensor));
  EXPECT_EQ(test::failure_of(next(**sensor)), Error::kSensorStale);
}

TEST(RtuRangeSensor, says_when_its_device_is_missing_or_unplugged) {
  {
    RtuRangeSensorConfiguration configuration;
    configuration.device = "/dev/nonexistent-sensor";
    const auto sensor = RtuRangeSensor::start(configuration);
    ASSERT_TRUE(sensor);
    const auto missing = next(**sensor);
    ASSERT_FALSE(missing);
    EXPECT_EQ(test::failure_of(missing), Error::kSensorPortGone);
    EXPECT_EQ((*sensor)->words(test::failure_of(missing)), "No such file or directory");
  }
  PtySensor line([](unsigned number) { return answer(1, static_cast<std::uint8_t>(number)); });
  const auto sensor = RtuRangeSensor::start(configuration_for(line));
  ASSERT_TRUE(sensor);
  ASSERT_TRUE(next(**sensor));
  line.unplug();
  Result<hal::RangeReading> polled = next(**sensor);
  while (polled) polled = next(**sensor);
  EXPECT_EQ(test::failure_of(polled), Error::kSensorPortGone);
}

// Tries come ever more seldom; between them the port is said to be missing, not the sensor to be
// silent, and the thread rests.
TEST(RtuRangeSensor, whose_port_is_missing_is_never_said_to_be_silent_and_does_not_spin) {
  RtuRangeSensorConfiguration configuration;
  configuration.device = "/dev/nonexistent-sensor";
  configuration.freshness = {.silent_after = milliseconds(20), .stale_after = milliseconds(20)};
  const auto sensor = RtuRangeSensor::start(configuration);
  ASSERT_TRUE(sensor);
  const auto processor_time = [] {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return std::chrono::seconds(time.tv_sec) + std::chrono::nanoseconds(time.tv_nsec);
  };
  const auto before = processor_time();
  const hal::Instant end = monotonic_now() + milliseconds(800);  // tries after 0, 100, 300, 700 ms
  int told = 0;
  while (monotonic_now() < end) {
    const auto polled = (*sensor)->poll(monotonic_now());
    if (!polled) {
      ASSERT_EQ(test::failure_of(polled), Error::kSensorPortGone);
      ++told;
    }
    std::this_thread::sleep_for(milliseconds(5));
  }
  EXPECT_GT(told, 8) << "told again and again, not only by the tries";
  EXPECT_LT(processor_time() - before, milliseconds(150));
}

TEST(RtuRangeSensor, refuses_a_profile_or_a_line_that_cannot_be) {
  RtuRangeSensorConfiguration configuration;
  configuration.device = "/dev/null";
  configuration.profile.unit = 0;
  EXPECT_EQ(test::failure_of(RtuRangeSensor::start(configuration)), Error::kProfileInvalid);
  configuration.profile.unit = 1;
  configuration.baud = 0;
  EXPECT_EQ(test::failure_of(RtuRangeSensor::start(configuration)), Error::kProfileInvalid);
}

TEST(RtuRangeSensor, tells_a_driver_that_turns_no_direction_of_a_transceiver) {
  PtySensor line([](unsigned number) { return answer(1, static_cast<std::uint8_t>(number)); });
  for (const Direction direction : {Direction::kRtsHigh, Direction::kRtsLow}) {
    RtuRangeSensorConfiguration configuration = configuration_for(line);
    configuration.direction = direction;  // a pseudo-terminal has none
    const auto sensor = RtuRangeSensor::start(configuration);
    ASSERT_TRUE(sensor);
    EXPECT_EQ(test::failure_of(next(**sensor)), Error::kSensorPortGone);
    EXPECT_NE((*sensor)->words(Error::kSensorPortGone).find("RS-485 direction"),
              std::string_view::npos);
  }
}

TEST(RtuRangeSensor, polling_never_waits) {
  PtySensor line([](unsigned) { return std::vector<std::uint8_t>(); });
  const auto sensor = RtuRangeSensor::start(configuration_for(line));
  ASSERT_TRUE(sensor);
  const hal::Instant begin = monotonic_now();
  for (int i = 0; i < 1000; ++i) (void)(*sensor)->poll(begin);
  EXPECT_LT(monotonic_now() - begin, milliseconds(40));  // less than one answer time-out
}

}  // namespace
}  // namespace armsig::linux_hal
