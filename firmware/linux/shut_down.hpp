// SPDX-License-Identifier: MIT
// The end of a controller: the drives are brought to rest before the process goes.
#pragma once

#include <chrono>

#include "hal/clock.hpp"
#include "hal/joint_drives.hpp"

namespace armsig::daemon {

inline constexpr hal::Duration kLongestShutDown = std::chrono::seconds(2);

// Quick stop of every drive; no torque, when all stand or the time of the ramps is over. Ticks the
// drives by itself, in place of a controller that no longer runs. Returns when no drive has torque,
// when the bus is gone and so nothing more can be told, or after kLongestShutDown. True if, as far
// as was heard, no drive has torque.
[[nodiscard]] bool shut_down(hal::JointDrives& drives, hal::Clock& clock, hal::Duration period);

}  // namespace armsig::daemon
