// SPDX-License-Identifier: MIT
// One point at one standstill: several pings, the median per receiver, the position.
#pragma once

#include <optional>
#include <string_view>

#include "core/measurement/ping_median.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/controller/configuration.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::controller {

struct MeasuredPoint {
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();
  std::size_t pings = 0;
};

class PointMeasurement {
 public:
  PointMeasurement(const Configuration& configuration, hal::RangeSensor& sensor);

  // The arm stands still from `now` on: earlier readings do not count.
  void begin(hal::Instant now);
  void end() {
    median_.reset();
    trilateration_.reset();
  }

  // Takes one reading of the sensor, whether or not a point is being measured; the point when it is
  // complete. Errors, after which begin() starts anew: kSensorStale, kSensorPortGone, kBusDown;
  // kSensorSilent, kSensorBadCrc, kSensorWrongUnit, kSensorException, kSensorMalformed (the third
  // in a row, or where there is no reading for the time allowed); kTemperatureImplausible,
  // kAirChanged; and, when the pings allowed are used up, the reason why they give no point
  // (measurement::trilaterate).
  [[nodiscard]] Result<std::optional<MeasuredPoint>> step(hal::Instant now);

  // Pings enough are in, and where they put the target is being worked out.
  [[nodiscard]] bool is_computing() const { return trilateration_.has_value(); }

  // Errors that the last readings were lost by; empty while readings come. For `status`.
  [[nodiscard]] std::optional<Error> trouble() const { return trouble_; }
  // What stands behind it, in words of the device or the operating system; may be empty.
  [[nodiscard]] std::string_view trouble_words() const {
    return trouble_ ? sensor_.words(*trouble_) : std::string_view();
  }
  [[nodiscard]] std::optional<double> air_celsius() const { return air_celsius_; }

 private:
  [[nodiscard]] Result<void> take_error(Error error);
  [[nodiscard]] Result<std::optional<MeasuredPoint>> take(const hal::RangeReading& reading);
  // A step of working out where the pings put the target.
  [[nodiscard]] Result<std::optional<MeasuredPoint>> locate(hal::Instant now);
  [[nodiscard]] Result<double> speed_in(const hal::RangeReading& reading);

  const Configuration& configuration_;
  hal::RangeSensor& sensor_;
  std::optional<measurement::PingMedian> median_;
  std::optional<measurement::Trilateration> trilateration_;  // of the pings so far
  hal::Instant began_;
  hal::Instant heard_at_;
  unsigned errors_in_a_row_ = 0;
  std::optional<Error> trouble_;
  std::optional<double> air_celsius_;
};

}  // namespace armsig::controller
