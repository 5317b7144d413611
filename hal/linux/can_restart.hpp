// SPDX-License-Identifier: MIT
// Asks the kernel to bring a CAN controller back from bus-off.
#pragma once

namespace armsig::linux_hal {

// Takes some tens of microseconds. Returns 0 or an errno value: EOPNOTSUPP where the interface has
// no controller to restart (vcan), EPERM without CAP_NET_ADMIN, EINVAL where it is not in bus-off
// or the kernel restarts it by itself (restart-ms).
[[nodiscard]] int restart_can_controller(unsigned interface_index);

}  // namespace armsig::linux_hal
