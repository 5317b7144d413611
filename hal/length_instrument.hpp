// SPDX-License-Identifier: MIT
// An instrument of several lengths that end at the target: draw-wire encoders, or distance meters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/reading_source.hpp"

namespace armsig::hal {

inline constexpr std::size_t kMaxLengths = 8;

struct LengthReading {
  // Metres, in the order of the anchors; empty: not read. Those behind the last are not there.
  FixedVector<std::optional<double>, kMaxLengths> lengths_m;
  // The earliest time at which they can have been measured.
  Instant at;
  std::uint32_t sequence = 0;  // differs between successive readings
};

using LengthInstrument = ReadingSource<LengthReading>;

}  // namespace armsig::hal
