// SPDX-License-Identifier: MIT
// The SDO requests that set up one CiA 402 drive, in order.
#pragma once

#include "hal/canopen/configuration.hpp"
#include "hal/cia402/setup.hpp"

namespace armsig::canopen {

// Type and mode are checked, identity and factor group (cia402/factors.hpp) read, heartbeats both
// ways set, every PDO switched off, RPDO1 and TPDO1 mapped and switched on (in the order that CiA
// 301, 7.5.2.36 demands: PDO off, entries to zero, entries, their number, PDO on), then what CiA
// 402 wants (cia402/setup.hpp).
[[nodiscard]] cia402::Setup drive_setup(const CheckedConfiguration& configuration,
                                        std::size_t axis);

}  // namespace armsig::canopen
