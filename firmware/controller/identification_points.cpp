// SPDX-License-Identifier: MIT
// One point of an identification: from the standstill of the arm to what is done with the point, or
// with its failure.
#include <cmath>

#include "firmware/controller/identification_sequence.hpp"

namespace armsig::controller {
namespace {

// Points in a row that give no position, until the sensor rather than the place is to blame.
constexpr unsigned kLostInARow = 3;
// Times in a row that a point may be begun anew because the arm moved.
constexpr unsigned kMovedInARow = 3;

bool is_of_the_place(Error error) {
  return error == Error::kTooFewReceivers || error == Error::kReceiversCollinear ||
         error == Error::kMirrorAmbiguity || error == Error::kRangesInconsistent ||
         error == Error::kSingular;
}

}  // namespace

void IdentificationSequence::measure() {
  const hal::Instant now = mover_.now().now;
  measurement_.begin(now);
  phase_ = Phase::kMeasuring;
  measured_since_ = now;
  phase_ends_ = now + configuration_.sensor.reading_timeout *
                          static_cast<std::int64_t>(configuration_.dwell.most_pings + 1);
}

// Whether a joint left its place, by more than the tolerance, since the first ping.
bool IdentificationSequence::has_moved() const {
  const Snapshot& snapshot = mover_.now();
  return snapshot.settled < snapshot.now - measured_since_;
}

// The pings of one point are of one place, or of none.
[[gnu::noinline]] void IdentificationSequence::refuse_point() {
  const std::size_t joint = mover_.furthest_joint();
  measurement_.end();
  if (++moved_in_a_row_ >= kMovedInARow) {
    end(Error::kArmMoved, joint);
    return;
  }
  announcer_.say(Line()
                     .text("# identify point refused")
                     .reason(Error::kArmMoved)
                     .text(" joint=")
                     .integer(joint + 1));
  phase_ = Phase::kMoving;
  phase_ends_ =
      mover_.now().now + configuration_.dwell.settle + configuration_.dwell.settle_timeout;
}

void IdentificationSequence::measure_step(const Result<std::optional<MeasuredPoint>>& measured) {
  if (!is_running() || phase_ != Phase::kMeasuring) return;
  if (has_moved()) {
    refuse_point();
  } else if (!measured) {
    take_error(measured.error());
  } else if (*measured) {
    take(**measured);
  }
}

void IdentificationSequence::take_error(Error error) {
  phase_ = Phase::kNext;
  if (!is_of_the_place(error)) {
    pause_for(error);
    return;
  }
  announcer_.say(Line().text("# identify point lost").reason(error));
  if (++lost_in_a_row_ >= kLostInARow) {
    pause_for(error);
  } else if (stage_ == Stage::kSweeping) {
    sweep().skip();
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
  phase_ = Phase::kNext;
  lost_in_a_row_ = moved_in_a_row_ = 0;
  ++points_done_;
  const JointVector& readings = mover_.now().positions;
  const bool sweeping = stage_ == Stage::kSweeping;
  if (!log_.full()) {
    log_.push_back({sweeping ? joint_ + 1 : 0, point.pings, readings, point.p_S,
                    std::sqrt(point.covariance_m2.trace() / 3)});
  }
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
