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

PointMeasurement::PointMeasurement(const Configuration& configuration, hal::RangeSensor& sensor)
    : configuration_(configuration), sensor_(sensor) {}

void PointMeasurement::begin(hal::Instant now) {
  began_ = heard_at_ = now;
  errors_in_a_row_ = 0;
  median_.emplace(configuration_.sensor.receivers.p_S.size());
  trilateration_.reset();
}

Result<std::optional<MeasuredPoint>> PointMeasurement::step(hal::Instant now) {
  if (trilateration_) return locate(now);
  auto polled = sensor_.poll(now);
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
  if (median_ && now - heard_at_ > configuration_.sensor.reading_timeout) {
    end();
    if (!is_of_the_line(trouble_)) trouble_ = Error::kSensorSilent;
    return std::unexpected(*trouble_);
  }
  return std::optional<MeasuredPoint>{};
}

Result<void> PointMeasurement::take_error(Error error) {
  trouble_ = error;
  ++errors_in_a_row_;
  if (!median_) return {};
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

}  // namespace armsig::controller
