// SPDX-License-Identifier: MIT
// A range sensor without a reading, and out of its port where a test says so.
#pragma once

#include "hal/range_sensor.hpp"

namespace armsig::test {

class SilentSensor final : public hal::RangeSensor {
 public:
  bool gone = false;
  std::optional<hal::RangeReading> reading;  // none: it says nothing

 private:
  Result<std::optional<hal::RangeReading>> do_poll(hal::Instant /*now*/) override {
    if (gone) return std::unexpected(Error::kSensorPortGone);
    return reading;
  }
  [[nodiscard]] std::string_view do_words(Error /*error*/) const override { return "unplugged"; }
};

}  // namespace armsig::test
