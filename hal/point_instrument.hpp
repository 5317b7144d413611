// SPDX-License-Identifier: MIT
// An instrument that says where the target is, in its own frame: a laser tracker, a camera, a
// draw-wire computer, a total station.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/pose.hpp"
#include "hal/reading_source.hpp"

namespace armsig::hal {

struct PointReading {
  Vector3 p_S = Vector3::Zero();
  std::optional<Matrix3> covariance_m2;  // empty: the instrument does not tell one
  // The earliest time at which it can have been measured.
  Instant at;
  std::uint32_t sequence = 0;  // differs between successive readings
};

using PointInstrument = ReadingSource<PointReading>;

}  // namespace armsig::hal
