// SPDX-License-Identifier: MIT
// Sensor description, sensor/1: where the receivers of a ranging sensor stand (docs/formats.md).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/formats/problem.hpp"

namespace armsig::tool {

inline constexpr std::string_view kSensorTag = "sensor/1";

struct SensorDescription {
  std::string name;
  std::vector<Vector3> receivers_S;  // 3 to 16, metres, not on one line
  double range_sigma_m = 0;          // 1 sigma of one range
  bool echo = false;  // the pulse travels out and back; otherwise from the emitter on the arm
  // The side of the receivers that the targets are on, unit vector; tells a target from its mirror
  // image where the receivers stand in one plane.
  std::optional<Vector3> facing_S;
  // The ranges of a measurement were computed with the speed of sound at this temperature, and are
  // to be multiplied by c(air)/c(this); nothing: they are taken as they are.
  std::optional<double> calibrated_at_c;
  // Not of the file: what a range may be off by beside its noise, 1 sigma, where offsets are yet to
  // be found. Points are told by it from ranges that do not meet, and are no less certain.
  double unknown_offset_m = 0;
};

[[nodiscard]] Read<SensorDescription> read_sensor_file(const std::string& path);
[[nodiscard]] Read<SensorDescription> parse_sensor(std::string_view text, std::string_view file);

// In metres with 17 digits; reading it gives the same bits, `facing` within rounding.
[[nodiscard]] std::string sensor_text(const SensorDescription& sensor);

// Writes atomically; refuses what could not be read back.
[[nodiscard]] Read<void> write_sensor_file(const std::string& path,
                                           const SensorDescription& sensor);

}  // namespace armsig::tool
