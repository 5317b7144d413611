// SPDX-License-Identifier: MIT
// CLOCK_MONOTONIC; every Instant of this folder's backends is told in it.
#pragma once

#include "hal/clock.hpp"

namespace armsig::linux_hal {

[[nodiscard]] hal::Instant monotonic_now();

class SteadyClock final : public hal::Clock {
  hal::Instant do_now() override { return monotonic_now(); }
  hal::Duration do_wait_until(hal::Instant tick) override;
  std::int64_t do_calendar_s() override;
};

}  // namespace armsig::linux_hal
