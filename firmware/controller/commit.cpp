// SPDX-License-Identifier: MIT
// `accept`, `rollback`, `acknowledge`: a change of the signature in use, from the request until the
// servo goes by what is stored; and what else is compared with what the memory kept.
#include <cmath>

#include "firmware/controller/background.hpp"

namespace armsig::controller {

Background::Verdict Background::accept() {
  const Mode mode = mover_.now().mode;
  if ((mode != Mode::kHolding && mode != Mode::kIdle) || is_busy()) {
    return std::unexpected(Error::kWrongMode);
  }
  if (!identification_.has_verdict()) return std::unexpected(Error::kNoCandidate);
  if (!identification_.report().is_better()) return std::unexpected(Error::kCandidateNoBetter);
  if (!custody_.fits()) return std::unexpected(Error::kAddressOutOfRange);
  if (!custody_.machine()) return std::unexpected(Error::kDrivesNotReady);
  identification_.stamp(clock_.calendar_s(), *custody_.machine());
  custody_.begin_write(*identification_.candidate());
  storing_ = Storing::kWriting;
  stores_ = accepting_ = true;
  return {};
}

Background::Verdict Background::rollback() {
  const Mode mode = mover_.now().mode;
  if ((mode != Mode::kHolding && mode != Mode::kIdle) || is_busy()) {
    return std::unexpected(Error::kWrongMode);
  }
  if (auto begun = custody_.begin_rollback(); !begun) return begun;
  storing_ = Storing::kWriting;
  stores_ = true;
  accepting_ = false;
  return {};
}

Background::Verdict Background::acknowledge() {
  if (!custody_.needs_acknowledgement()) return std::unexpected(Error::kWrongMode);
  custody_.acknowledge();
  out_.text(" model=drawing");
  return {};
}

// The drives have told who they are.
void Background::look_at_machine() {
  const Machine& machine = link_.machine.read();
  const bool known = machine.drives.size() == configuration_.drawing.joints.size();
  if (known) custody_.compare(machine);
  custody_.tell_trouble(announcer_);
}

// The arm may have been moved by hand while it had no torque: that is told, for the operator to
// know whether it was.
void Background::look_at_positions() {
  constexpr double kMoved_rad = radians(0.5);
  constexpr double kMoved_m = 1e-3;
  if (positions_compared_) return;
  positions_compared_ = true;
  const JointVector& now = mover_.now().positions;
  const auto kept = positions_.load(now.size());
  for (std::size_t i = 0; kept && i < now.size(); ++i) {
    const bool turns = configuration_.drawing.joints[i].type == JointType::kRevolute;
    const double moved = now[i] - (*kept)[i];
    if (!(std::abs(moved) > (turns ? kMoved_rad : kMoved_m))) continue;
    Line line;
    line.text("# moved without power joint=").integer(i + 1).text(turns ? " by_deg=" : " by_mm=");
    announcer_.say(line.number(turns ? degrees(moved) : 1e3 * moved, 3));
  }
}

// Where the arm rests is kept when its torque is off: once a `disable`, and not while it may be
// pushed about.
void Background::keep_positions() {
  const Snapshot& now = mover_.now();
  const bool torque =
      now.mode == Mode::kHolding || now.mode == Mode::kServoing || now.mode == Mode::kSweeping;
  had_torque_ = had_torque_ || torque;
  if (positions_.is_writing()) {
    positions_.step();
  } else if (had_torque_ && now.mode == Mode::kIdle && now.all_disabled && positions_compared_) {
    had_torque_ = false;
    positions_.begin(now.positions);
  }
}

// The servo takes over what is active, so that it is never other than what the status says.
void Background::adopt() {
  model_ = 1 - mover_.now().model;
  const auto& active = custody_.active();
  link_.models[model_] = active ? model_of(active->signature, configuration_.drawing)
                                : model_of(configuration_.drawing);
  storing_ = Storing::kAdopting;
}

void Background::step_store() {
  if (storing_ == Storing::kWriting) {
    step_writing();
  } else if (storing_ == Storing::kAdopting) {
    step_adopting();
  } else if (link_.models[mover_.now().model].identified != custody_.active().has_value()) {
    adopt();  // it has turned out to be of another machine
  }
}

// After an error as well, what is stored is what counts: it may be the old or the new.
void Background::step_writing() {
  const auto written = custody_.step();
  if (written && !*written) return;
  stored_ = written ? Result<void>() : std::unexpected(written.error());
  custody_.load();
  if (stored_ && custody_.trouble()) stored_ = std::unexpected(*custody_.trouble());
  if (stored_ && accepting_) identification_.forget_candidate();
  adopt();
}

void Background::step_adopting() {
  if (mover_.now().model != model_) {
    Command command;
    command.kind = CommandKind::kAdoptModel;
    command.model = model_;
    if (mover_.is_handled(adopt_ticket_)) {
      adopt_ticket_ = mover_.send(command).value_or(adopt_ticket_);
    }
    return;
  }
  storing_ = Storing::kNothing;
  if (!storing_for_) return;
  client_ = *storing_for_;
  storing_for_.reset();
  out_.clear();
  reply(stored_);
}

}  // namespace armsig::controller
