// SPDX-License-Identifier: MIT
#include "firmware/host_tool/reading/ranging.hpp"

#include <cmath>

#include <fmt/core.h>

#include "core/measurement/speed_of_sound.hpp"

namespace armsig::tool {

measurement::ReceiverArray receivers_of(const SensorDescription& sensor) {
  measurement::ReceiverArray array;
  for (const Vector3& p_S : sensor.receivers_S) array.p_S.push_back(p_S);
  array.range_sigma_m = sensor.range_sigma_m;
  array.facing_S = sensor.facing_S.value_or(Vector3::Zero());
  return array;
}

Read<double> range_scale(const MeasurementRow& row, const std::optional<SensorDescription>& sensor,
                         const std::string& file) {
  if (row.ranges_m.empty()) return 1.0;
  const auto line = static_cast<int>(row.line);
  if (!sensor) {
    return std::unexpected(Problem{file, line, 0, "the rows are ranges to receivers",
                                   "--sensor with a description of where the receivers stand"});
  }
  if (row.ranges_m.size() != sensor->receivers_S.size()) {
    return std::unexpected(
        Problem{file, line, 0, fmt::format("ranges to {} receivers", row.ranges_m.size()),
                fmt::format("{}, as the sensor description has", sensor->receivers_S.size())});
  }
  if (!sensor->calibrated_at_c) return 1.0;
  if (!row.air_c) {
    return std::unexpected(Problem{file, line, 0, "no air temperature",
                                   "a column air_c: the sensor's ranges depend on it"});
  }
  const auto speed = measurement::speed_of_sound(*row.air_c);
  const auto assumed = measurement::speed_of_sound(*sensor->calibrated_at_c);
  if (!speed || !assumed) {
    return std::unexpected(Problem{file, line, 0,
                                   fmt::format("an air temperature of {} °C", *row.air_c),
                                   "an air temperature in degrees Celsius"});
  }
  return *speed / *assumed;
}

Result<measurement::Position> locate(const MeasurementRow& row, const SensorDescription& sensor,
                                     double scale) {
  measurement::Ranges ranges;
  for (const std::optional<double>& range_m : row.ranges_m) {
    ranges.push_back({.metres = scale * range_m.value_or(0), .valid = range_m.has_value()});
  }
  measurement::ReceiverArray receivers = receivers_of(sensor);
  if (row.sigma_m) receivers.range_sigma_m = *row.sigma_m;
  const double sigma_m = receivers.range_sigma_m;
  receivers.range_sigma_m = std::hypot(sigma_m, sensor.unknown_offset_m);
  auto position = measurement::trilaterate(receivers, ranges);
  const double share = sigma_m / receivers.range_sigma_m;
  if (position) position->covariance_m2 *= share * share;
  return position;
}

}  // namespace armsig::tool
