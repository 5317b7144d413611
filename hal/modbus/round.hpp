// SPDX-License-Identifier: MIT
// One reading after the other, request by request, whoever carries requests and answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/base/error.hpp"
#include "hal/modbus/channels.hpp"
#include "hal/modbus/profile.hpp"
#include "hal/modbus/rtu.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::modbus {

// What makes a reading: the registers of `profile`, or the channels where there are any.
struct Source {
  Profile profile{};
  std::optional<ChannelProfile> channels{};
};

// The requests of a round. Errors: kProfileInvalid, as registers_of() and requests_of().
[[nodiscard]] Result<Requests> requests_of(const Source& source);

// begin(), then a take() or a fail() for each request that next() hands out, then finish().
class Round {
 public:
  // Precondition: requests_of(source).
  explicit Round(const Source& source);

  void begin(hal::Instant now);

  // What is to be asked next; empty: the round is complete. A unit that failed is not asked again
  // in the same round: its late answer would be taken for the one to another request.
  [[nodiscard]] std::optional<ReadRequest> next();

  // The answer to the last request, as long as it asked for.
  void take(std::span<const std::uint16_t> registers);
  void fail(Error error);

  // The reading, which ended at `now`. Of channels, those whose unit failed are invalid.
  // Its time is, of channels, the earliest at which the sensor can have measured it.
  // Errors: the first one that was not silence where no channel was answered, or the air or the
  // counter was not; kSensorSilent where all were silent; kSensorMalformed (air that is not finite;
  // decode()).
  [[nodiscard]] Result<hal::RangeReading> finish(hal::Instant now);

  // The first unit that failed in this round, by its first error; empty: none has.
  [[nodiscard]] std::optional<hal::FailingUnit> failing_unit() const {
    return failed_units_.empty() ? std::nullopt
                                 : std::optional(hal::FailingUnit{failed_units_[0], first_error_});
  }

 private:
  void take_channels(std::span<const std::uint16_t> registers);
  [[nodiscard]] bool has_failed(std::uint8_t unit) const;

  Source source_;
  Requests requests_;
  std::size_t asked_ = 0;  // requests handed out or passed over
  FixedVector<std::uint8_t, kMaxFields> failed_units_;
  Error first_error_ = Error::kSensorSilent;  // of failed_units_[0]
  std::optional<Error> error_;
  bool heard_ = false;  // a channel was answered
  // What stands in the channels' fields; not a number where nobody answered.
  FixedVector<double, kMaxReceivers> numbers_;
  std::optional<double> air_celsius_;
  std::optional<std::uint32_t> counter_;
  hal::RangeReading reading_;
  hal::Instant began_;
  hal::Instant counted_at_;  // when the last round began in which the counter was read
  std::uint32_t rounds_ = 0;
};

}  // namespace armsig::modbus
