// SPDX-License-Identifier: MIT
// The end of a controller: the drives are brought to rest before the process goes.
#pragma once

#include <chrono>

#include "hal/clock.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::daemon {

inline constexpr hal::Duration kLongestShutDown = std::chrono::seconds(2);

// Quick stop of every drive, then no torque; ticks the drives by itself, in place of a controller
// that no longer runs. Returns when all are disabled, when one is faulted or the bus is gone and so
// nothing more can be told, or after kLongestShutDown. True if all are disabled.
bool shut_down(hal::JointDrives& drives, hal::Clock& clock, hal::Duration period);

}  // namespace armsig::daemon
