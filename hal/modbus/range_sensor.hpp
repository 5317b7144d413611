// SPDX-License-Identifier: MIT
// A Modbus RTU range sensor on a serial line that never blocks, for targets without an operating
// system.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "hal/byte_stream.hpp"
#include "hal/freshness.hpp"
#include "hal/modbus/profile.hpp"
#include "hal/modbus/rtu_master.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::modbus {

struct RangeSensorConfiguration {
  Profile profile{};
  RtuTiming timing{};
  hal::Duration poll_period = std::chrono::milliseconds(20);  // from request to request
  hal::FreshnessLimits freshness{};
};

class RangeSensor final : public hal::RangeSensor {
 public:
  // Precondition: registers_of(configuration.profile). `line` must outlive the sensor.
  RangeSensor(const RangeSensorConfiguration& configuration, hal::ByteStream& line);

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant now) override;
  [[nodiscard]] std::uint8_t do_exception_code() const override { return exception_; }
  [[nodiscard]] std::string_view do_words(Error error) const override {
    return error == Error::kSensorException ? describe_exception(exception_) : std::string_view();
  }

  RangeSensorConfiguration configuration_;
  ReadRequest request_;
  RtuMaster master_;
  hal::Freshness freshness_;
  std::optional<hal::Instant> requested_at_;
  std::uint8_t exception_ = 0;
};

}  // namespace armsig::modbus
