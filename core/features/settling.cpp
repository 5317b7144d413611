// SPDX-License-Identifier: MIT
#include "core/features/settling.hpp"

namespace armsig::features {

Settling::Settling(const SweepState& state)
    : state_(state), accepted_(state.accepted), rejected_(state.rejected) {
  if (state.waiting.empty()) {
    stage_ = Stage::kOver;
  } else if (state.waiting_is_accepted && is_consistent(accepted_)) {
    stage_ = Stage::kReview;
  } else {
    begin_judging();
  }
}

void Settling::begin_judging() {
  if (state_.waiting_is_accepted) accepted_ = SweepStatistics(accepted_.type, accepted_.method);
  judging_.emplace(accepted_, state_.sigma_is_known, state_.waiting);
  done_ = 0;
  stage_ = Stage::kJudge;
}

bool Settling::step() {
  switch (stage_) {
    case Stage::kReview:
      review_next();
      return true;
    case Stage::kJudge:
      if (!judging_->step()) stage_ = Stage::kTake;
      return true;
    case Stage::kTake:
      take_next();
      return true;
    case Stage::kOver:
      break;
  }
  return false;
}

void Settling::review_next() {
  if (!is_confirmed(accepted_, state_.waiting[done_])) {
    begin_judging();
  } else if (++done_ == state_.waiting.size()) {
    stage_ = Stage::kOver;
  }
}

void Settling::take_next() {
  if (judging_->result()[done_]) {
    accepted_.add(state_.waiting[done_]);
  } else {
    ++rejected_;
  }
  if (++done_ < state_.waiting.size()) return;
  stage_ = Stage::kOver;
}

}  // namespace armsig::features
