// SPDX-License-Identifier: MIT
// Rows that are ranges to receivers: what a sensor description makes of them.
#pragma once

#include <optional>
#include <string>

#include "core/measurement/receivers.hpp"
#include "core/measurement/trilateration.hpp"
#include "firmware/formats/measurements.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/formats/sensor_file.hpp"

namespace armsig::tool {

// The receivers of a sensor description, as core wants them.
[[nodiscard]] measurement::ReceiverArray receivers_of(const SensorDescription& sensor);

// What the ranges of `row` are to be multiplied by: the speed of sound of its air over the one that
// they were computed with; 1 for a row without ranges. Refuses, in the words of `file`, ranges
// without a sensor, to another number of receivers, or without the air temperature that they need.
[[nodiscard]] Read<double> range_scale(const MeasurementRow& row,
                                       const std::optional<SensorDescription>& sensor,
                                       const std::string& file);

// Where the ranges of a row, multiplied by `scale`, put its target; each as uncertain as the row
// states, else the sensor. Errors: those of measurement::trilaterate().
[[nodiscard]] Result<measurement::Position> locate(const MeasurementRow& row,
                                                   const SensorDescription& sensor, double scale);

}  // namespace armsig::tool
