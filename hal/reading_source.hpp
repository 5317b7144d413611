// SPDX-License-Identifier: MIT
// Where readings of one kind come from: an instrument, behind whatever connects it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/error.hpp"
#include "hal/clock.hpp"

namespace armsig::hal {

template <typename Reading>
class ReadingSource {
 public:
  // The newest reading, if one has arrived since; each is handed out once at most. Never blocks. An
  // error is told once and does not end anything, as those of RangeSensor::poll(): kSensorSilent,
  // kSensorStale, kSensorMalformed, kSensorException, kSensorWrongUnit (of a Modbus server),
  // kSensorPortGone (nobody is connected, or nobody can be).
  [[nodiscard]] Result<std::optional<Reading>> poll(Instant now) { return do_poll(now); }

  // What stands behind `error`, the last that poll() told, for the console; may be empty.
  [[nodiscard]] std::string_view words(Error error) const { return do_words(error); }

  // How much of what came was no reading, since the start.
  [[nodiscard]] std::uint32_t malformed() const { return do_malformed(); }

 protected:
  ~ReadingSource() = default;

 private:
  virtual Result<std::optional<Reading>> do_poll(Instant now) = 0;
  [[nodiscard]] virtual std::string_view do_words(Error) const { return {}; }
  [[nodiscard]] virtual std::uint32_t do_malformed() const { return 0; }
};

}  // namespace armsig::hal
