// SPDX-License-Identifier: MIT
// One point of an identification: what is done with it, or with its failure.
#include <cmath>

#include "firmware/controller/identification_sequence.hpp"

namespace armsig::controller {
namespace {

// Points in a row that give no position, until the sensor rather than the place is to blame.
constexpr unsigned kLostInARow = 3;
// Of poses that are spread further than the sensor may see.
constexpr unsigned kPosesLostInARow = 8;

}  // namespace

void IdentificationSequence::lose(Error error) {
  if (!is_of_the_place(error)) {
    pause_for(error);
    return;
  }
  announcer_.say(Line().text("# identify point lost").reason(error));
  const bool refining = stage_ == Stage::kRefining;
  if (++lost_in_a_row_ >= (refining ? kPosesLostInARow : kLostInARow)) {
    pause_for(error);
  } else if (stage_ == Stage::kSweeping) {
    sweep().skip();
  } else if (refining) {
    approached_ = false;
    refinement_->lose();
  } else {
    ++held_out_;
  }
}

void IdentificationSequence::pause_for(Error error) {
  paused_ = true;
  pause_reason_ = error;
  announcer_.say(Line().text("# identify paused").reason(error).text(" go on with resume"));
}

void IdentificationSequence::take(const MeasuredPoint& point) {
  lost_in_a_row_ = 0;
  ++points_done_;
  const JointVector& readings = mover_.now().positions;
  const bool sweeping = stage_ == Stage::kSweeping;
  if (!received_ && !log_.full()) {
    log_.push_back({sweeping ? joint_ + 1 : 0, point.pings, readings, point.p_S,
                    std::sqrt(point.covariance_m2.trace() / 3)});
  }
  if (refines_) {
    refinement_->take(sweeping ? joint_ + 1 : 0, readings, point);
    approached_ = false;
  }
  if (stage_ == Stage::kRefining) return;
  if (!sweeping) {
    comparison().judge(readings, point.p_S);
    ++held_out_;
    return;
  }
  if (auto added = sweep().add(readings[joint_], point.p_S, point.covariance_m2); !added) {
    end(added.error(), joint_);
    return;
  }
  if (sweep().done() % 10 == 0) tell_progress("sweep");
}

}  // namespace armsig::controller
