// SPDX-License-Identifier: MIT
#include "hal/cia402/group.hpp"

#include <algorithm>

namespace armsig::cia402 {

void Group::set_goal(Goal goal, hal::Instant now) {
  const bool stops = goal_ == Goal::kEnabled && goal != Goal::kEnabled;
  goal_ = goal;
  for (Drive* drive : drives_) drive->set_goal(goal, now);
  if (stops) stopping_since_ = now;
  update_release(now);
}

void Group::supervise(hal::Instant now) {
  const bool fault = std::ranges::any_of(
      drives_, [](const Drive* drive) { return drive->state().fault.has_value(); });
  if (fault && goal_ == Goal::kEnabled) set_goal(Goal::kStopped, now);
  update_release(now);
}

void Group::update_release(hal::Instant now) {
  if (!stopping_since_) return;
  const bool stand =
      std::ranges::all_of(drives_, [](const Drive* drive) { return drive->state().stands; });
  if (!stand && now - *stopping_since_ <= settings_.stop_timeout) return;
  for (Drive* drive : drives_) {
    if (!drive->state().stands) drive->latch(Error::kStopTimeout);
  }
  stopping_since_.reset();
}

Result<void> Group::set_targets(const JointVector& targets, hal::Instant now) {
  Result<void> result;
  const bool enabled = std::ranges::all_of(
      drives_, [](const Drive* drive) { return drive->is_enabled() && drive->state().arrived; });
  for (std::size_t joint = 0; joint < drives_.size(); ++joint) {
    const auto set = drives_[joint]->set_target(targets[joint], enabled, settings_.period, now);
    if (!set && result) result = set;
  }
  return result;
}

void Group::latch_all(Error error) {
  for (Drive* drive : drives_) drive->latch(error);
}

}  // namespace armsig::cia402
