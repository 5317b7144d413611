// SPDX-License-Identifier: MIT
// The drives of one arm: one goal for all, one fault stops all. Stopping and stopped are two
// conditions: after a stop no torque may be taken off before every joint stands, or
// GroupSettings::stop_timeout is over.
#pragma once

#include <optional>

#include "core/base/arm.hpp"
#include "core/base/fixed_vector.hpp"
#include "hal/cia402/drive.hpp"

namespace armsig::cia402 {

class Group {
 public:
  explicit Group(const GroupSettings& settings) : settings_(settings) {}

  // At most kMaxJoints, from the base to the tip. `drive` must outlive the group.
  void add(Drive& drive) { drives_.push_back(&drive); }

  // Where the drives are wanted from now on.
  void set_goal(Goal goal, hal::Instant now);
  // Once a tick, after Drive::supervise() of all. Latches kStopTimeout.
  void supervise(hal::Instant now);
  // The torque may be taken off.
  [[nodiscard]] bool may_release() const { return !stopping_since_; }
  // Targets of all, in radians or metres. Errors as Drive::set_target, of the first that has one.
  Result<void> set_targets(const JointVector& targets, hal::Instant now);
  void latch_all(Error error);

 private:
  void update_release(hal::Instant now);

  GroupSettings settings_;
  FixedVector<Drive*, kMaxJoints> drives_;
  Goal goal_ = Goal::kDisabled;
  std::optional<hal::Instant> stopping_since_;  // until every position stands
};

}  // namespace armsig::cia402
