// SPDX-License-Identifier: MIT
// The speed of sound by the temperature alone, for whatever turns times into lengths and back.
#pragma once

#include <cmath>

namespace armsig {

// Dry air as an ideal gas: c(T) = 331.3 sqrt(1 + T / 273.15) m/s, (M1) of docs/model.md. Not a
// number below absolute zero.
[[nodiscard]] inline double speed_in_dry_air(double celsius) {
  return 331.3 * std::sqrt(1.0 + celsius / 273.15);
}

}  // namespace armsig
