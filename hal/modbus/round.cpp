// SPDX-License-Identifier: MIT
#include "hal/modbus/round.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/check.hpp"

namespace armsig::modbus {

Result<Requests> requests_of(const Source& source) {
  if (source.channels) return requests_of(*source.channels);
  ARMSIG_TRY(registers, registers_of(source.profile));
  Requests requests;
  requests.push_back({source.profile.unit, source.profile.function, registers});
  return requests;
}

Round::Round(const Source& source) : source_(source) {
  const auto requests = requests_of(source);
  ARMSIG_CHECK(requests);
  requests_ = *requests;
}

void Round::begin(hal::Instant now) {
  ++rounds_;
  began_ = now;
  asked_ = 0;
  failed_units_.clear();
  error_.reset();
  heard_ = false;
  air_celsius_.reset();
  counter_.reset();
  reading_ = {};
  numbers_.clear();
  if (source_.channels) {
    numbers_.resize(source_.channels->channels.size(), std::numeric_limits<double>::quiet_NaN());
  }
}

bool Round::has_failed(std::uint8_t unit) const {
  return std::ranges::find(failed_units_, unit) != failed_units_.end();
}

std::optional<ReadRequest> Round::next() {
  while (asked_ < requests_.size()) {
    const ReadRequest& request = requests_[asked_++];
    if (!has_failed(request.unit)) return request;
  }
  return std::nullopt;
}

void Round::take(std::span<const std::uint16_t> registers) {
  ARMSIG_CHECK(asked_ > 0);
  if (source_.channels) {
    take_channels(registers);
    return;
  }
  if (const auto reading = decode(source_.profile, registers)) {
    reading_ = *reading;
  } else {
    error_ = reading.error();
  }
}

void Round::take_channels(std::span<const std::uint16_t> registers) {
  const ChannelProfile& profile = *source_.channels;
  const ReadRequest& request = requests_[asked_ - 1];
  for (std::size_t j = 0; j < profile.channels.size(); ++j) {
    const Field& field = profile.channels[j].field;
    if (!covers(request, field)) continue;
    heard_ = true;
    numbers_[j] = number_in(field, request, registers);
  }
  if (profile.air && covers(request, *profile.air)) {
    air_celsius_ = profile.air->step * number_in(*profile.air, request, registers);
  }
  if (profile.counter && covers(request, *profile.counter)) {
    counter_ = static_cast<std::uint32_t>(
        static_cast<std::int64_t>(number_in(*profile.counter, request, registers)));
  }
}

void Round::fail(Error error) {
  ARMSIG_CHECK(asked_ > 0);
  if (failed_units_.empty()) first_error_ = error;
  failed_units_.push_back(requests_[asked_ - 1].unit);
  if (!error_ || *error_ == Error::kSensorSilent) error_ = error;
}

Result<hal::RangeReading> Round::finish(hal::Instant now) {
  if (!source_.channels) {
    if (error_) return std::unexpected(*error_);
    reading_.at = now;
    return reading_;
  }
  const ChannelProfile& profile = *source_.channels;
  if (!heard_ || (profile.air && !air_celsius_) || (profile.counter && !counter_)) {
    return std::unexpected(error_.value_or(Error::kSensorSilent));
  }
  reading_.air_celsius = air_celsius_.value_or(profile.fixed_air_celsius);
  if (!std::isfinite(reading_.air_celsius)) return std::unexpected(Error::kSensorMalformed);
  const double speed_m_s = speed_of(profile, reading_.air_celsius);
  for (std::size_t j = 0; j < numbers_.size(); ++j) {
    reading_.receivers.push_back(reading_of(profile, profile.channels[j], numbers_[j], speed_m_s));
  }
  reading_.sequence = counter_.value_or(rounds_);
  // A value is as old as the sensor's period at most. With a counter, one that is new is younger
  // than the last look at the counter; of the first nothing is known.
  reading_.at =
      profile.counter ? std::exchange(counted_at_, began_) : began_ - profile.update_period;
  return reading_;
}

}  // namespace armsig::modbus
