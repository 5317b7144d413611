// SPDX-License-Identifier: MIT
// One point at one standstill: several pings, the median per receiver, the position; or several
// points of an instrument, and their median.
#pragma once

#include <optional>
#include <string_view>

#include "core/measurement/ping_median.hpp"
#include "core/measurement/point_median.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/instrument.hpp"

namespace armsig::controller {

struct MeasuredPoint {
  Vector3 p_S = Vector3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();
  std::size_t pings = 0;
};

// What an instrument of points has measured of the pose.
#ifdef ARMSIG_RANGES_ALONE
struct PointsOfPose {
  static constexpr void end() {}
  [[nodiscard]] static constexpr bool is_measuring() { return false; }
  [[nodiscard]] static constexpr bool heard() { return false; }
};
#else
class PointsOfPose {
 public:
  void begin() { median_.emplace(); }
  void end() { median_.reset(); }
  void hear() { heard_ = true; }
  [[nodiscard]] bool is_measuring() const { return median_.has_value(); }
  // Since the start.
  [[nodiscard]] bool heard() const { return heard_; }
  // Precondition: is_measuring().
  [[nodiscard]] measurement::PointMedian& median() { return *median_; }

 private:
  std::optional<measurement::PointMedian> median_;
  bool heard_ = false;
};
#endif

class PointMeasurement {
 public:
  PointMeasurement(const Configuration& configuration, Instrument instrument);

  // The arm stands still from `now` on: earlier readings do not count.
  void begin(hal::Instant now);
  void end() {
    median_.reset();
    trilateration_.reset();
    points_.end();
  }

  // Whether there is anything to measure with.
  [[nodiscard]] bool has_instrument() const {
    return !kMayTakePoints || instrument_.ranges() != nullptr || instrument_.points() != nullptr;
  }

  // Takes one reading of the sensor, whether or not a point is being measured; the point when it is
  // complete. Errors, after which begin() starts anew: kSensorStale, kSensorPortGone, kBusDown;
  // kSensorSilent, kSensorBadCrc, kSensorWrongUnit, kSensorException, kSensorMalformed (the third
  // in a row, or where there is no reading for the time allowed); kTemperatureImplausible,
  // kAirChanged; and, when the pings allowed are used up, the reason why they give no point
  // (measurement::trilaterate, measurement::PointMedian).
  [[nodiscard]] Result<std::optional<MeasuredPoint>> step(hal::Instant now);

  // Pings enough are in, and where they put the target is being worked out.
  [[nodiscard]] bool is_computing() const { return trilateration_.has_value(); }

  // Errors that the last readings were lost by; empty while readings come. For `status`.
  [[nodiscard]] std::optional<Error> trouble() const { return trouble_; }
  // What stands behind it, in words of the device or the operating system; may be empty.
  [[nodiscard]] std::string_view trouble_words() const {
    if (!trouble_) return {};
    if constexpr (kMayTakePoints) {
      if (instrument_.points() != nullptr) return instrument_.points()->words(*trouble_);
      if (instrument_.ranges() == nullptr) return {};
    }
    return instrument_.ranges()->words(*trouble_);
  }
  // Of a range sensor of several units, one that fails while others answer.
  [[nodiscard]] std::optional<hal::FailingUnit> failing_unit() const {
    return instrument_.ranges() == nullptr ? std::nullopt : instrument_.ranges()->failing_unit();
  }
  // Readings have come.
  [[nodiscard]] bool has_heard() const { return air_celsius_ || points_.heard(); }
  // How much of what an instrument sent was no reading.
  [[nodiscard]] std::uint32_t malformed() const {
    return kMayTakePoints && instrument_.points() != nullptr ? instrument_.points()->malformed()
                                                             : 0;
  }
  [[nodiscard]] std::optional<double> air_celsius() const { return air_celsius_; }

 private:
  [[nodiscard]] bool is_measuring() const { return median_.has_value() || points_.is_measuring(); }
  [[nodiscard]] Result<void> take_error(Error error);
  // Neither a reading nor an error came.
  [[nodiscard]] Result<std::optional<MeasuredPoint>> wait(hal::Instant now);
  // As step(), of an instrument of points.
  [[nodiscard]] Result<std::optional<MeasuredPoint>> step_points(hal::Instant now);
  [[nodiscard]] Result<std::optional<MeasuredPoint>> take(const hal::PointReading& reading);
  [[nodiscard]] Result<std::optional<MeasuredPoint>> take(const hal::RangeReading& reading);
  // A step of working out where the pings put the target.
  [[nodiscard]] Result<std::optional<MeasuredPoint>> locate(hal::Instant now);
  [[nodiscard]] Result<double> speed_in(const hal::RangeReading& reading);

  const Configuration& configuration_;
  Instrument instrument_;
  std::optional<measurement::PingMedian> median_;
  std::optional<measurement::Trilateration> trilateration_;  // of the pings so far
  hal::Instant began_;
  hal::Instant heard_at_;
  unsigned errors_in_a_row_ = 0;
  std::optional<Error> trouble_;
  std::optional<double> air_celsius_;
  [[no_unique_address]] PointsOfPose points_;
};

}  // namespace armsig::controller
