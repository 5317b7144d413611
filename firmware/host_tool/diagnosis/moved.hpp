// SPDX-License-Identifier: MIT
// Rows that were measured from another place of the sensor, or with another tool: found by trying
// every block of the file, then row by row.
#pragma once

#include <optional>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

struct Moved {
  Evidence evidence;  // with those rows marked, or their target renumbered
  NearFit fit;
  std::size_t first_line = 0;
  std::size_t last_line = 0;
  double shift_m = 0;  // how far the sensor seems to have been carried, at the middle of the rows
  Vector3 along_S = Vector3::Zero();
  double turn_rad = 0;
};

// The rows that fit best as measured from a second place; nothing where the file is one block.
[[nodiscard]] std::optional<Moved> find_moved_sensor(const Evidence& evidence,
                                                     const ArmLimits& limits);
// The rows up to the end of the file from which on the last target is another point.
[[nodiscard]] std::optional<Moved> find_changed_tool(const Evidence& evidence,
                                                     const ArmLimits& limits);

}  // namespace armsig::tool
