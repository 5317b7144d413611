// SPDX-License-Identifier: MIT
#include "firmware/controller/commit.hpp"

#include <utility>

namespace armsig::controller {

Commit::Commit(const Configuration& configuration, Custody& custody,
               IdentificationSequence& identification, Mover& mover, Link& link)
    : configuration_(configuration),
      custody_(custody),
      identification_(identification),
      mover_(mover),
      link_(link) {
  make_model_in_use(link_.models[0]);
}

void Commit::make_model_in_use(Model& model) const {
  const auto& active = custody_.active();
  if (active) {
    make_model(*active, configuration_.drawing, model);
  } else {
    make_model(configuration_.drawing, model);
  }
}

Result<void> Commit::begin_accept(bool confirmed) {
  if (hal::kSmallImage || !confirmed) {
    if (!identification_.has_verdict()) return std::unexpected(Error::kNoCandidate);
    if (!identification_.report().is_better()) return std::unexpected(Error::kCandidateNoBetter);
  } else if (!identification_.has_received()) {
    return std::unexpected(Error::kNoCandidate);
  }
  if (!custody_.fits()) return std::unexpected(Error::kAddressOutOfRange);
  if (!custody_.machine()) return std::unexpected(Error::kDrivesNotReady);
  custody_.begin_write(*identification_.candidate());
  stage_ = Stage::kWriting;
  asked_for_ = accepts_ = true;
  return {};
}

Result<void> Commit::begin_rollback() {
  if (auto begun = custody_.begin_rollback(); !begun) return begun;
  stage_ = Stage::kWriting;
  asked_for_ = true;
  accepts_ = false;
  return {};
}

std::optional<Result<void>> Commit::step() {
  if (stage_ == Stage::kWriting) {
    write();
  } else if (stage_ == Stage::kResting) {
    // What is stored may have turned out to be of another machine.
    if (link_.models[mover_.now().model].identified != custody_.active().has_value()) adopt();
  } else if (mover_.now().model != model_) {
    if (!mover_.is_handled(ticket_)) return std::nullopt;
    Command command;
    command.kind = CommandKind::kAdoptModel;
    command.index = model_;
    ticket_ = mover_.send(command).value_or(ticket_);
  } else {
    stage_ = Stage::kResting;
    if (std::exchange(asked_for_, false)) return written_;
  }
  return std::nullopt;
}

// After an error as well, what is stored is what counts: it may be the old or the new.
void Commit::write() {
  const auto done = custody_.step();
  if (done && !*done) return;
  written_ = done ? Result<void>() : std::unexpected(done.error());
  custody_.load();
  if (written_ && custody_.trouble()) written_ = std::unexpected(*custody_.trouble());
  if (written_ && accepts_) {
    identification_.forget_candidate();
  } else if (custody_.machine()) {
    identification_.compare_conditions(*custody_.machine(), custody_.in_use());
  }
  adopt();
}

// The servo takes over what is active, so that it is never other than what the status says.
void Commit::adopt() {
  model_ = 1 - mover_.now().model;
  make_model_in_use(link_.models[model_]);
  stage_ = Stage::kAdopting;
}

}  // namespace armsig::controller
