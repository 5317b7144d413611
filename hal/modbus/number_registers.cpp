// SPDX-License-Identifier: MIT
#include "hal/modbus/number_registers.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::modbus {
namespace {

Field field_of(const NumberProfile& profile, std::uint16_t first) {
  return {.unit = profile.unit,
          .function = profile.function,
          .first = first,
          .format = profile.format,
          .high_word_first = profile.high_word_first};
}

Field counter_of(const NumberProfile& profile) {
  return {.unit = profile.unit,
          .function = profile.function,
          .first = *profile.counter,
          .format = Format::kU16};
}

bool is_sane(const NumberProfile& profile) {
  return !profile.registers.empty() && profile.unit >= 1 && profile.unit <= kLargestUnit &&
         (profile.function == 3 || profile.function == 4) && profile.metres_a_step > 0 &&
         std::isfinite(profile.metres_a_step) &&
         profile.counter.has_value() != (profile.update_period > hal::Duration{});
}

}  // namespace

Result<ReadRequest> request_of(const NumberProfile& profile) {
  if (!is_sane(profile)) return std::unexpected(Error::kProfileInvalid);
  FixedVector<Field, kMaxNumbers + 1> fields;
  for (const std::uint16_t first : profile.registers) fields.push_back(field_of(profile, first));
  if (profile.counter) fields.push_back(counter_of(profile));
  std::size_t first = kRegisters;
  std::size_t end = 0;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (overlap(fields[i], fields[j])) return std::unexpected(Error::kProfileInvalid);
    }
    first = std::min<std::size_t>(first, fields[i].first);
    end = std::max(end, end_of(fields[i]));
  }
  if (end > kRegisters || end - first > kMaxRegisters) {
    return std::unexpected(Error::kProfileInvalid);
  }
  return ReadRequest{profile.unit,
                     profile.function,
                     {static_cast<std::uint16_t>(first), static_cast<std::uint16_t>(end - first)}};
}

RegisterNumbers numbers_in(const NumberProfile& profile, const ReadRequest& request,
                           std::span<const std::uint16_t> registers) {
  RegisterNumbers numbers;
  for (const std::uint16_t first : profile.registers) {
    const double number = number_in(field_of(profile, first), request, registers);
    numbers.metres.push_back(profile.metres_a_step * number);
  }
  if (profile.counter) {
    numbers.sequence =
        static_cast<std::uint32_t>(number_in(counter_of(profile), request, registers));
  }
  return numbers;
}

}  // namespace armsig::modbus
