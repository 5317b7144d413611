// SPDX-License-Identifier: MIT
#include "hal/modbus/point_registers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace armsig::modbus {
namespace {

std::array<Field, 3> coordinates_of(const PointProfile& profile) {
  const auto field = [&](std::uint16_t first) {
    return Field{.unit = profile.unit,
                 .function = profile.function,
                 .first = first,
                 .format = profile.format,
                 .high_word_first = profile.high_word_first};
  };
  return {field(profile.x), field(profile.y), field(profile.z)};
}

Field counter_of(const PointProfile& profile) {
  return {.unit = profile.unit,
          .function = profile.function,
          .first = *profile.counter,
          .format = Format::kU16};
}

bool is_sane(const PointProfile& profile) {
  return profile.unit >= 1 && profile.unit <= kLargestUnit &&
         (profile.function == 3 || profile.function == 4) && profile.metres_a_step > 0 &&
         std::isfinite(profile.metres_a_step) &&
         profile.counter.has_value() != (profile.update_period > hal::Duration{});
}

}  // namespace

Result<ReadRequest> request_of(const PointProfile& profile) {
  if (!is_sane(profile)) return std::unexpected(Error::kProfileInvalid);
  FixedVector<Field, 4> fields;
  for (const Field& field : coordinates_of(profile)) fields.push_back(field);
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

Result<RegisterPoint> point_in(const PointProfile& profile, const ReadRequest& request,
                               std::span<const std::uint16_t> registers, double farthest_m) {
  RegisterPoint point;
  Eigen::Index axis = 0;
  for (const Field& field : coordinates_of(profile)) {
    const double metres = profile.metres_a_step * number_in(field, request, registers);
    if (!(std::abs(metres) <= farthest_m)) return std::unexpected(Error::kSensorMalformed);
    point.p_S[axis++] = metres;
  }
  if (profile.counter) {
    point.sequence = static_cast<std::uint32_t>(number_in(counter_of(profile), request, registers));
  }
  return point;
}

}  // namespace armsig::modbus
