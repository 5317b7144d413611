// SPDX-License-Identifier: MIT
// One or several units of Modbus RTU as a range sensor, on a serial line that never blocks, for
// targets without an operating system.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/byte_stream.hpp"
#include "hal/freshness.hpp"
#include "hal/modbus/round.hpp"
#include "hal/modbus/rtu_master.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::modbus {

struct RangeSensorConfiguration {
  Profile profile{};
  std::optional<ChannelProfile> channels{};  // where there are any, instead of `profile`
  RtuTiming timing{};
  hal::Duration poll_period = std::chrono::milliseconds(20);  // from round to round
  hal::FreshnessLimits freshness{};
};

class RangeSensor final : public hal::RangeSensor {
 public:
  // Precondition: requests_of() the profile or the channels. `line` must outlive the sensor.
  RangeSensor(const RangeSensorConfiguration& configuration, hal::ByteStream& line);

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override;
  [[nodiscard]] std::uint8_t do_exception_code() const override { return exception_; }
  [[nodiscard]] std::string_view do_words(Error error) const override {
    return error == Error::kSensorException ? describe_exception(exception_) : std::string_view();
  }

#ifndef ARMSIG_SMALL_IMAGE
  [[nodiscard]] std::optional<hal::FailingUnit> do_failing_unit() const override {
    return failing_;
  }
#endif

  [[nodiscard]] bool is_due(hal::Instant now) const;
  Result<void> ask(hal::Instant now);

  RangeSensorConfiguration configuration_;
  Round round_;
  RtuMaster master_;
  hal::Freshness freshness_;
  std::optional<ReadRequest> next_;  // as soon as the line is idle
  std::optional<hal::Instant> began_at_;
  hal::Instant ended_at_;
  std::uint8_t exception_ = 0;
  std::optional<hal::FailingUnit> failing_;  // in the last round
};

}  // namespace armsig::modbus
