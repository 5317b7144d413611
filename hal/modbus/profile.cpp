// SPDX-License-Identifier: MIT
#include "hal/modbus/profile.hpp"

#include <algorithm>

namespace armsig::modbus {

Result<RegisterRange> registers_of(const Profile& profile) {
  const bool sane = profile.unit >= 1 && profile.unit <= kLargestUnit &&
                    (profile.function == 3 || profile.function == 4) && profile.receivers >= 1 &&
                    profile.receivers <= kMaxReceivers && profile.flight_stride >= 2 &&
                    profile.celsius_a_step > 0 && profile.seconds_a_step > 0;
  if (!sane) return std::unexpected(Error::kProfileInvalid);
  const std::size_t last_flight =
      profile.first_flight + profile.flight_stride * (profile.receivers - 1) + 1;
  const std::size_t singles[] = {profile.status, profile.sequence, profile.air_temperature,
                                 profile.receiver_count};
  const std::size_t first = std::min<std::size_t>(std::ranges::min(singles), profile.first_flight);
  const std::size_t last = std::max(std::ranges::max(singles), last_flight);
  if (last > 0xFFFF || last - first + 1 > kMaxRegisters) {
    return std::unexpected(Error::kProfileInvalid);
  }
  return RegisterRange{static_cast<std::uint16_t>(first),
                       static_cast<std::uint16_t>(last - first + 1)};
}

Result<hal::RangeReading> decode(const Profile& profile, std::span<const std::uint16_t> registers) {
  ARMSIG_TRY(range, registers_of(profile));
  if (registers.size() != range.count) return std::unexpected(Error::kSensorMalformed);
  const auto at = [&](std::size_t number) { return registers[number - range.first]; };
  if (at(profile.receiver_count) < profile.receivers) {
    return std::unexpected(Error::kSensorMalformed);
  }
  hal::RangeReading reading;
  reading.sequence = at(profile.sequence);
  reading.air_celsius =
      profile.celsius_a_step * static_cast<std::int16_t>(at(profile.air_temperature));
  for (std::size_t j = 0; j < profile.receivers; ++j) {
    const std::size_t number = profile.first_flight + profile.flight_stride * j;
    const std::uint32_t high = at(number + (profile.high_word_first ? 0 : 1));
    const std::uint32_t low = at(number + (profile.high_word_first ? 1 : 0));
    const double flight = ((high << 16) | low) * profile.seconds_a_step;
    reading.receivers.push_back(
        {(at(profile.status) >> j & 1U) != 0, profile.echo ? flight / 2 : flight});
  }
  return reading;
}

}  // namespace armsig::modbus
