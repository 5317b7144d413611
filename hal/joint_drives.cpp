// SPDX-License-Identifier: MIT
#include "hal/joint_drives.hpp"

#include "core/base/check.hpp"

namespace armsig::hal {

DriveStatus JointDrives::status(std::size_t joint) const {
  ARMSIG_CHECK(joint < count());
  return do_status(joint);
}

std::optional<DriveIdentity> JointDrives::identity(std::size_t joint) const {
  ARMSIG_CHECK(joint < count());
  return do_identity(joint);
}

std::optional<DeviceObject> JointDrives::gap(std::size_t joint, std::size_t number) const {
  ARMSIG_CHECK(joint < count());
  return do_gap(joint, number);
}

Result<void> JointDrives::home(std::size_t joint) {
  ARMSIG_CHECK(joint < count());
  if (!all(DriveCondition::kEnabled)) return std::unexpected(Error::kDrivesNotReady);
  return do_home(joint);
}

bool JointDrives::all(DriveCondition condition) const {
  for (std::size_t joint = 0; joint < count(); ++joint) {
    if (do_status(joint).condition != condition) return false;
  }
  return true;
}

Result<void> JointDrives::write(const JointVector& targets, Instant now) {
  ARMSIG_CHECK(targets.size() == count());
  return do_write(targets, now);
}

}  // namespace armsig::hal
