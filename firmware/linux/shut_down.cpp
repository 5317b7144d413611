// SPDX-License-Identifier: MIT
#include "firmware/linux/shut_down.hpp"

namespace armsig::daemon {
namespace {

using hal::DriveCondition;

// The stop is given this much of what there is; then the torque goes, whatever the drives say.
constexpr hal::Duration kRamp = 3 * kLongestShutDown / 4;

// Whether every drive stands in its quick stop, or has no torque that a stop could wait for.
bool all_rest(const hal::JointDrives& drives) {
  for (std::size_t joint = 0; joint < drives.count(); ++joint) {
    const hal::DriveStatus status = drives.status(joint);
    if (status.condition != DriveCondition::kStopped && status.has_torque) return false;
  }
  return true;
}

bool any_has_torque(const hal::JointDrives& drives) {
  for (std::size_t joint = 0; joint < drives.count(); ++joint) {
    if (drives.status(joint).has_torque) return true;
  }
  return false;
}

}  // namespace

bool shut_down(hal::JointDrives& drives, hal::Clock& clock, hal::Duration period) {
  if (drives.all(DriveCondition::kDisabled)) return true;
  const hal::Instant began = clock.now();
  hal::Instant next = began;
  bool stopping = true;
  drives.quick_stop();
  while (clock.now() - began < kLongestShutDown) {
    const bool heard = drives.read(clock.now()).has_value();
    (void)drives.write(drives.positions(), clock.now());
    if (!heard || (!stopping && !any_has_torque(drives))) break;
    if (stopping && (all_rest(drives) || clock.now() - began > kRamp)) {
      stopping = false;
      drives.disable();
    }
    next += period;
    clock.wait_until(next);
  }
  return !any_has_torque(drives);
}

}  // namespace armsig::daemon
