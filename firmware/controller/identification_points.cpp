// SPDX-License-Identifier: MIT
// One point of an identification: what is done with it, or with its failure.
#include <cmath>

#include "firmware/controller/identification_sequence.hpp"

namespace armsig::controller {
namespace {

// Points in a row that give no position, until the sensor rather than the place is to blame.
constexpr unsigned kLostInARow = 3;
// So many of the held-out ones are looked for where the arm is clear.
constexpr std::size_t kMostSpread = 1000;
// Of poses that are spread further than the sensor may see.
constexpr unsigned kPosesLostInARow = 8;

}  // namespace

// Ends it by what was measured, which is of no use to a later run.
void IdentificationSequence::refuse(Error error, std::optional<std::size_t> joint) {
  if (refines()) forget_kept();
  end(error, joint);
}

[[gnu::noinline]] void IdentificationSequence::forget_kept() {
  if (const auto forgotten = refinement_->forget(); !forgotten) {
    announcer_.say(Line().text("# identify kept points are not erased").reason(forgotten.error()));
  }
}

// Of the pose where the arm stands; `point` null: there is none. Apart, as below what take() calls
// there is no room for it.
[[gnu::noinline]] void IdentificationSequence::keep(const MeasuredPoint* point) {
  const bool sweeping = stage_ == Stage::kSweeping;
  if (!sweeping && refinement_->visit().again) return;
  KeptPoint kept{.sweep = sweeping ? joint_ + 1 : 0,
                 .wanted = sweeping ? mover_.now().commanded : refinement_->visit().pose,
                 .readings = mover_.now().positions};
  if (point != nullptr) kept.point = *point;
  if (const auto done = refinement_->keep(kept); !done) {
    announcer_.say(
        Line().text("# identify can't be continued after a restart").reason(done.error()));
  }
}

// True: an interrupted run was there, and what it measured is taken.
[[gnu::noinline]] bool IdentificationSequence::recall(const JointVector& wanted) {
  const std::size_t sweep = stage_ == Stage::kSweeping ? joint_ + 1 : 0;
  const auto kept = refinement_->recall(sweep, wanted);
  if (!kept) return false;
  visit_.forget_look();
  if (kept->point) {
    ++recalled_;
    take(*kept->point, kept->readings);
  } else {
    skip();
  }
  return true;
}

// The same for what ready() goes to next: a point of the sweep at `q`, or the refinement's.
bool IdentificationSequence::recall_next(const JointVector& q) {
  if (stage_ == Stage::kSweeping) return refines() && recall(q);
  if (!is_refining() || approached_) return false;
  const Refinement::Visit& visit = refinement_->visit();
  return !visit.again && recall(visit.pose);
}

// What is around the arm excludes the pose that was to be next.
void IdentificationSequence::pass_over() {
  if (stage_ == Stage::kSweeping) {
    sweep().turn_back();
  } else if (is_refining()) {
    skip();
  } else if (held_out_ + ++passed_over_ >= kMostSpread) {
    end(Error::kOutsideWorkspace);
  }
}

void IdentificationSequence::lose(Error error) {
  if (!is_of_the_place(error)) {
    pause_for(error);
    return;
  }
  announcer_.say(Line().text("# identify point lost").reason(error));
  const bool refining = is_refining();
  if (++lost_in_a_row_ >= (refining ? kPosesLostInARow : kLostInARow)) {
    pause_for(error);
  } else {
    if (refines()) keep(nullptr);
    skip();
  }
}

void IdentificationSequence::skip() {
  if (stage_ == Stage::kSweeping) {
    sweep().skip();
  } else if (is_refining()) {
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
  if (refines()) keep(&point);
  take(point, mover_.now().positions);
}

void IdentificationSequence::take(const MeasuredPoint& point, const JointVector& readings) {
  lost_in_a_row_ = 0;
  ++points_done_;
  const bool sweeping = stage_ == Stage::kSweeping;
  if (!received_ && !log_.full()) {
    log_.push_back({sweeping ? joint_ + 1 : 0, point.pings, readings, point.p_S,
                    std::sqrt(point.covariance_m2.trace() / 3)});
  }
  if (refines()) {
    refinement_->take(sweeping ? joint_ + 1 : 0, readings, point);
    approached_ = false;
  }
  if (is_refining()) return;
  if (!sweeping) {
    comparison().judge(readings, point.p_S);
    ++held_out_;
    return;
  }
  if (auto added = sweep().add(readings[joint_], point.p_S, point.covariance_m2); !added) {
    refuse(added.error(), joint_);
    return;
  }
  if (sweep().done() % 10 == 0) tell_progress("sweep");
}

}  // namespace armsig::controller
