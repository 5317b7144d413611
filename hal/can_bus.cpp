// SPDX-License-Identifier: MIT
#include "hal/can_bus.hpp"

#include "core/base/check.hpp"

namespace armsig::hal {

Result<void> CanBus::send(const CanFrame& frame) {
  ARMSIG_CHECK(frame.length <= kMaxCanData);
  ARMSIG_CHECK(frame.id < (frame.extended ? 1U << 29 : 1U << 11));
  return do_send(frame);
}

}  // namespace armsig::hal
