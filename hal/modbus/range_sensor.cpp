// SPDX-License-Identifier: MIT
#include "hal/modbus/range_sensor.hpp"

#include <span>

namespace armsig::modbus {

RangeSensor::RangeSensor(const RangeSensorConfiguration& configuration, hal::ByteStream& line)
    : configuration_(configuration),
      round_({.profile = configuration.profile, .channels = configuration.channels}),
      master_(configuration.timing, line),
      freshness_(configuration.freshness) {}

// Without a counter, two rounds are as far apart as two readings of the sensor, whichever of their
// requests took long.
bool RangeSensor::is_due(hal::Instant now) const {
  if (!began_at_) return true;
  const bool counted = !configuration_.channels || configuration_.channels->counter;
  return now - *began_at_ >= configuration_.poll_period &&
         (counted || now - ended_at_ >= configuration_.channels->update_period);
}

Result<void> RangeSensor::ask(hal::Instant now) {
  const ReadRequest request = *next_;
  next_.reset();
  return master_.start(request, now);
}

Result<std::optional<hal::RangeReading>> RangeSensor::do_poll(hal::Instant now) {
  if (const auto answer = master_.poll(now)) {
    ended_at_ = now;
    if (*answer) {
      const Registers& registers = **answer;
      round_.take({registers.data(), registers.size()});
    } else {
      const Failure& failure = answer->error();
      if (failure.error == Error::kSensorException) exception_ = failure.exception;
      round_.fail(failure.error);
    }
    next_ = round_.next();
    if (!next_) {
      const auto reading = round_.finish(now);
      failing_ = round_.failing_unit();
      if (reading && freshness_.take(reading->sequence, now)) return *reading;
      // A round without an answer is the line's business; silence has its own limit.
      if (!reading && reading.error() != Error::kSensorSilent) {
        return std::unexpected(reading.error());
      }
    }
  }
  if (master_.idle(now)) {
    if (!next_ && is_due(now)) {
      began_at_ = now;
      round_.begin(now);
      next_ = round_.next();
    }
    if (next_) {
      if (auto asked = ask(now); !asked) return std::unexpected(asked.error());
    }
  }
  if (const auto overdue = freshness_.overdue(now)) return std::unexpected(*overdue);
  return std::nullopt;
}

}  // namespace armsig::modbus
