// SPDX-License-Identifier: MIT
// A sensor that measures the flight time of a pulse from the target to k fixed receivers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/flight_time.hpp"
#include "hal/clock.hpp"

namespace armsig::hal {

// What one receiver heard. A range is the flight time times the speed of sound at the air
// temperature (docs/model.md, section 1), which is the measurement stage's business.
struct ReceiverReading {
  bool valid = false;
  double flight_s = 0;  // one way, from the target to the receiver; echoes are halved already
};

struct RangeReading {
  FixedVector<ReceiverReading, kMaxReceivers> receivers;
  double air_celsius = 0;  // as told by the sensor, plausible or not
  // When the reading reached the controller; of a sensor whose values may be older, the earliest
  // time at which they can have been measured.
  Instant at;
  std::uint32_t sequence = 0;  // differs between successive readings
};

// A unit that does not answer as it should while others do.
struct FailingUnit {
  std::uint8_t unit = 0;
  Error error = Error::kSensorSilent;
};

class RangeSensor {
 public:
  // The next reading, if a new one has arrived; each is handed out once, and a reading whose
  // sequence number has not advanced is not handed out. Never blocks. An error is told once and
  // does not end anything: polling goes on and readings come again when the cause is gone.
  // Errors: kSensorSilent (nothing for the time allowed), kSensorStale (answers, but the sequence
  // has not advanced for the time allowed), kSensorBadCrc, kSensorWrongUnit, kSensorException,
  // kSensorMalformed, kSensorPortGone (the line is gone or was never there), kBusDown.
  [[nodiscard]] Result<std::optional<RangeReading>> poll(Instant now) { return do_poll(now); }

  // The device's own code of the last kSensorException, for the console; 0 if there was none.
  [[nodiscard]] std::uint8_t exception_code() const { return do_exception_code(); }

  // What stands behind `error`, the last that poll() told, in words of the device's protocol or of
  // the operating system, for the console; empty: nothing more is known.
  [[nodiscard]] std::string_view words(Error error) const { return do_words(error); }

  // Of a sensor that is made up of several units, the first one that failed in the last reading;
  // empty: none did.
  [[nodiscard]] std::optional<FailingUnit> failing_unit() const {
#ifdef ARMSIG_SMALL_IMAGE  // whose sensor is one node
    return std::nullopt;
#else
    return do_failing_unit();
#endif
  }

 protected:
  ~RangeSensor() = default;

 private:
  virtual Result<std::optional<RangeReading>> do_poll(Instant now) = 0;
  [[nodiscard]] virtual std::uint8_t do_exception_code() const { return 0; }
  [[nodiscard]] virtual std::string_view do_words(Error) const { return {}; }
#ifndef ARMSIG_SMALL_IMAGE
  [[nodiscard]] virtual std::optional<FailingUnit> do_failing_unit() const { return {}; }
#endif
};

}  // namespace armsig::hal
