// SPDX-License-Identifier: MIT
// An instrument that says where the target is, in its own frame: a laser tracker, a camera, a
// draw-wire computer, a total station.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "core/base/pose.hpp"
#include "hal/clock.hpp"

namespace armsig::hal {

struct PointReading {
  Vector3 p_S = Vector3::Zero();
  std::optional<Matrix3> covariance_m2;  // empty: the instrument does not tell one
  // The earliest time at which it can have been measured.
  Instant at;
  std::uint32_t sequence = 0;  // differs between successive readings
};

class PointInstrument {
 public:
  // The newest reading, if one has arrived since; each is handed out once at most. Never blocks. An
  // error is told once and does not end anything, as those of RangeSensor::poll(): kSensorSilent,
  // kSensorStale, kSensorMalformed, kSensorException, kSensorWrongUnit (of a Modbus server),
  // kSensorPortGone (nobody is connected, or nobody can be).
  [[nodiscard]] Result<std::optional<PointReading>> poll(Instant now) { return do_poll(now); }

  // What stands behind `error`, the last that poll() told, for the console; may be empty.
  [[nodiscard]] std::string_view words(Error error) const { return do_words(error); }

  // How much of what came was no reading, since the start.
  [[nodiscard]] std::uint32_t malformed() const { return do_malformed(); }

 protected:
  ~PointInstrument() = default;

 private:
  virtual Result<std::optional<PointReading>> do_poll(Instant now) = 0;
  [[nodiscard]] virtual std::string_view do_words(Error) const { return {}; }
  [[nodiscard]] virtual std::uint32_t do_malformed() const { return 0; }
};

}  // namespace armsig::hal
