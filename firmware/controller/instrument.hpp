// SPDX-License-Identifier: MIT
// What measures the target: a sensor of ranges, an instrument of points, or nothing.
#pragma once

#include "hal/joint_drives.hpp"
#include "hal/point_instrument.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::controller {

#ifdef ARMSIG_RANGES_ALONE
inline constexpr bool kMayTakePoints = false;
#else
inline constexpr bool kMayTakePoints = true;
#endif

class Instrument {
 public:
  Instrument() = default;  // nothing
  // NOLINTNEXTLINE(google-explicit-constructor): reads like the sensor that it is
  Instrument(hal::RangeSensor& sensor) : ranges_(&sensor) {}
#ifndef ARMSIG_RANGES_ALONE
  // NOLINTNEXTLINE(google-explicit-constructor): reads like the instrument that it is
  Instrument(hal::PointInstrument& instrument) : points_(&instrument) {}
#endif

  // Null: it has none.
  [[nodiscard]] hal::RangeSensor* ranges() const { return ranges_; }
#ifdef ARMSIG_RANGES_ALONE
  [[nodiscard]] static hal::PointInstrument* points() { return nullptr; }
#else
  [[nodiscard]] hal::PointInstrument* points() const { return points_; }
#endif

 private:
  hal::RangeSensor* ranges_ = nullptr;
#ifndef ARMSIG_RANGES_ALONE
  hal::PointInstrument* points_ = nullptr;
#endif
};

}  // namespace armsig::controller
