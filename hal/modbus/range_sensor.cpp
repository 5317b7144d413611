// SPDX-License-Identifier: MIT
#include "hal/modbus/range_sensor.hpp"

#include <span>

#include "core/base/check.hpp"

namespace armsig::modbus {
namespace {

ReadRequest request_of(const Profile& profile) {
  const auto registers = registers_of(profile);
  ARMSIG_CHECK(registers);
  return {profile.unit, profile.function, *registers};
}

}  // namespace

RangeSensor::RangeSensor(const RangeSensorConfiguration& configuration, hal::ByteStream& line)
    : configuration_(configuration),
      request_(request_of(configuration.profile)),
      master_(configuration.timing, line),
      freshness_(configuration.freshness) {}

Result<std::optional<hal::RangeReading>> RangeSensor::do_poll(hal::Instant now) {
  if (auto answer = master_.poll(now)) {
    if (!*answer) {
      // A single request without an answer is the line's business; silence has its own limit.
      if (answer->error().error != Error::kSensorSilent) {
        exception_ = answer->error().exception;
        return std::unexpected(answer->error().error);
      }
    } else {
      const Registers& registers = **answer;
      ARMSIG_TRY(reading, decode(configuration_.profile, {registers.data(), registers.size()}));
      reading.at = now;
      if (freshness_.take(reading.sequence, now)) return reading;
    }
  }
  const bool due = !requested_at_ || now - *requested_at_ >= configuration_.poll_period;
  if (due && master_.idle(now)) {
    requested_at_ = now;
    if (auto started = master_.start(request_, now); !started) {
      return std::unexpected(started.error());
    }
  }
  if (const auto overdue = freshness_.overdue(now)) return std::unexpected(*overdue);
  return std::nullopt;
}

}  // namespace armsig::modbus
