// SPDX-License-Identifier: MIT
#include "hal/canopen/bus_load.hpp"

#include "core/base/check.hpp"

namespace armsig::canopen {

double bus_load(std::span<const PeriodicFrame> frames, std::uint32_t bits_per_second) {
  ARMSIG_CHECK(bits_per_second > 0);
  double load = 0;
  for (const PeriodicFrame& frame : frames) {
    ARMSIG_CHECK(frame.period > hal::Duration::zero());
    load += worst_case_bits(frame.data_bytes) / (bits_per_second * hal::seconds(frame.period));
  }
  return load;
}

}  // namespace armsig::canopen
