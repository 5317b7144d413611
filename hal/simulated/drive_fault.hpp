// SPDX-License-Identifier: MIT
// Faults of an emulated drive by their names, as people ask for them.
#pragma once

#include <optional>
#include <string_view>

#include "hal/simulated/drive.hpp"

namespace armsig::simulated {

// none, emergency, silent, heartbeat, feedback, blocked, power, reboot, deaf, jump,
// pre-operational, sdo, sync, ignores, bits-clear, bits-set, information; empty: there is no such
// fault.
[[nodiscard]] std::optional<DriveFault> drive_fault(std::string_view name);

}  // namespace armsig::simulated
