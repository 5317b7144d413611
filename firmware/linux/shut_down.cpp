// SPDX-License-Identifier: MIT
#include "firmware/linux/shut_down.hpp"

namespace armsig::daemon {
namespace {

using hal::DriveCondition;

// The standard's quick stop ramp takes its time; the stop is given this much of what there is.
constexpr hal::Duration kRamp = kLongestShutDown / 2;

bool any_faulted(const hal::JointDrives& drives) {
  for (std::size_t joint = 0; joint < drives.count(); ++joint) {
    if (drives.status(joint).condition == DriveCondition::kFaulted) return true;
  }
  return false;
}

}  // namespace

bool shut_down(hal::JointDrives& drives, hal::Clock& clock, hal::Duration period) {
  const hal::Instant began = clock.now();
  hal::Instant next = began;
  bool stopping = !drives.all(DriveCondition::kDisabled);
  if (!stopping) return true;
  drives.quick_stop();
  while (clock.now() - began < kLongestShutDown) {
    const bool heard = drives.read(clock.now()).has_value();
    (void)drives.write(drives.positions(), clock.now());
    const bool rested = drives.all(DriveCondition::kStopped) || clock.now() - began > kRamp;
    if (stopping && rested) {
      stopping = false;
      drives.disable();
    } else if (!stopping && drives.all(DriveCondition::kDisabled)) {
      return true;
    }
    if (!heard || (!stopping && any_faulted(drives))) break;
    next += period;
    clock.wait_until(next);
  }
  return drives.all(DriveCondition::kDisabled);
}

}  // namespace armsig::daemon
