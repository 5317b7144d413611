// SPDX-License-Identifier: MIT
#include "firmware/controller/point_measurement.hpp"

#include <cmath>

#include "core/measurement/speed_of_sound.hpp"

namespace armsig::controller {
namespace {

// One answer may be spoilt on the line; a fault spoils them all.
constexpr unsigned kErrorsInARow = 3;

bool is_passing(Error error) {
  return error == Error::kSensorSilent || error == Error::kSensorBadCrc ||
         error == Error::kSensorWrongUnit || error == Error::kSensorException ||
         error == Error::kSensorMalformed;
}

// Of what carries the readings, so that the sensor itself is not to blame.
bool is_of_the_line(std::optional<Error> error) {
  return error == Error::kSensorPortGone || error == Error::kBusDown;
}

}  // namespace

PointMeasurement::PointMeasurement(const Configuration& configuration, Instrument instrument)
    : configuration_(configuration), instrument_(instrument) {}

void PointMeasurement::begin(hal::Instant now) {
  began_ = heard_at_ = now;
  errors_in_a_row_ = 0;
  trilateration_.reset();
#ifndef ARMSIG_RANGES_ALONE
  if (instrument_.ranges() == nullptr) {
    points_.begin();
    return;
  }
#endif
  median_.emplace(configuration_.sensor.receivers.p_S.size());
}

// In line: a small image has one caller, and no room for a call.
inline Result<std::optional<MeasuredPoint>> PointMeasurement::wait(hal::Instant now) {
  if (is_measuring() && now - heard_at_ > configuration_.sensor.reading_timeout) {
    end();
    if (!is_of_the_line(trouble_)) trouble_ = Error::kSensorSilent;
    return std::unexpected(*trouble_);
  }
  return std::optional<MeasuredPoint>{};
}

Result<std::optional<MeasuredPoint>> PointMeasurement::step(hal::Instant now) {
  if (trilateration_) return locate(now);
  if constexpr (kMayTakePoints) {
    if (instrument_.ranges() == nullptr) return step_points(now);
  }
  auto polled = instrument_.ranges()->poll(now);
  if (polled && *polled &&
      (*polled)->receivers.size() != configuration_.sensor.receivers.p_S.size()) {
    polled = std::unexpected(Error::kSensorMalformed);
  }
  if (!polled) {
    if (auto taken = take_error(polled.error()); !taken) return std::unexpected(taken.error());
  } else if (*polled) {
    errors_in_a_row_ = 0;
    trouble_.reset();
    heard_at_ = now;
    return take(**polled);
  }
  return wait(now);
}

Result<void> PointMeasurement::take_error(Error error) {
  trouble_ = error;
  ++errors_in_a_row_;
  if (!is_measuring()) return {};
  if (is_passing(error) && errors_in_a_row_ < kErrorsInARow) return {};
  end();
  return std::unexpected(error);
}

Result<double> PointMeasurement::speed_in(const hal::RangeReading& reading) {
  const Sensor& sensor = configuration_.sensor;
  if (!(reading.air_celsius >= sensor.lowest_air_celsius &&
        reading.air_celsius <= sensor.highest_air_celsius)) {
    return std::unexpected(Error::kTemperatureImplausible);
  }
  const std::optional<double> before = air_celsius_;
  air_celsius_ = reading.air_celsius;
  if (before && std::abs(reading.air_celsius - *before) > sensor.largest_air_step_kelvin) {
    return std::unexpected(Error::kAirChanged);
  }
  return measurement::speed_of_sound(reading.air_celsius);
}

Result<std::optional<MeasuredPoint>> PointMeasurement::take(const hal::RangeReading& reading) {
  const auto speed = speed_in(reading);
  if (!speed) {
    if (auto taken = take_error(speed.error()); !taken) return std::unexpected(taken.error());
    return std::optional<MeasuredPoint>();
  }
  if (!median_ || reading.at < began_) return std::optional<MeasuredPoint>();
  FlightTimes flights;
  for (const hal::ReceiverReading& receiver : reading.receivers) {
    flights.push_back({.seconds = receiver.flight_s, .valid = receiver.valid});
  }
  const auto ranges =
      measurement::ranges_from_times(flights, *speed, measurement::SoundPath::kOneWay);
  if (auto added = median_->add(ranges); !added) {
    end();
    return std::unexpected(added.error());
  }
  if (median_->pings() < configuration_.dwell.pings) return std::optional<MeasuredPoint>();
  trilateration_.emplace(configuration_.sensor.receivers, median_->median());
  return std::optional<MeasuredPoint>();
}

Result<std::optional<MeasuredPoint>> PointMeasurement::locate(hal::Instant now) {
  heard_at_ = now;  // the sensor is not listened to meanwhile
  if (trilateration_->step()) return std::optional<MeasuredPoint>();
  const auto position = trilateration_->result();
  trilateration_.reset();
  if (position) {
    const MeasuredPoint point{position->p_S, position->covariance_m2, median_->pings()};
    end();
    return std::optional(point);
  }
  if (median_->pings() < configuration_.dwell.most_pings) return std::optional<MeasuredPoint>();
  end();
  return std::unexpected(position.error());
}

#ifndef ARMSIG_RANGES_ALONE
Result<std::optional<MeasuredPoint>> PointMeasurement::step_points(hal::Instant now) {
  if (instrument_.points() == nullptr) return std::optional<MeasuredPoint>();
  const auto polled = instrument_.points()->poll(now);
  if (!polled) {
    if (auto taken = take_error(polled.error()); !taken) return std::unexpected(taken.error());
  } else if (*polled) {
    errors_in_a_row_ = 0;
    trouble_.reset();
    heard_at_ = now;
    points_.hear();
    return take(**polled);
  }
  return wait(now);
}

Result<std::optional<MeasuredPoint>> PointMeasurement::take(const hal::PointReading& reading) {
  if (!points_.is_measuring() || reading.at < began_) return std::optional<MeasuredPoint>();
  const double sigma_m = configuration_.sensor.point_sigma_m;
  const Matrix3 as_configured = sigma_m * sigma_m * Matrix3::Identity();
  measurement::PointMedian& points = points_.median();
  const auto added = points.add(reading.p_S, reading.covariance_m2.value_or(as_configured));
  if (!added) {
    end();
    return std::unexpected(added.error());
  }
  const std::size_t count = points.points();
  if (count < configuration_.dwell.pings) return std::optional<MeasuredPoint>();
  const auto median = points.result();
  if (!median && count < configuration_.dwell.most_pings) return std::optional<MeasuredPoint>();
  end();
  if (!median) return std::unexpected(median.error());
  return std::optional(MeasuredPoint{median->p_S, median->covariance_m2, count});
}
#else
Result<std::optional<MeasuredPoint>> PointMeasurement::step_points(hal::Instant /*now*/) {
  return std::optional<MeasuredPoint>();
}
#endif

}  // namespace armsig::controller
