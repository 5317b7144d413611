// SPDX-License-Identifier: MIT
#include "firmware/controller/servo.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/check.hpp"

namespace armsig::controller {
namespace {

// A move is planned from where the arm is commanded to be; one planned from elsewhere would jump.
constexpr double kSameReading = 1e-9;

}  // namespace

Servo::Servo(const Configuration& configuration, hal::JointDrives& drives, hal::Clock& clock,
             Link& link)
    : configuration_(configuration), drives_(drives), clock_(clock), link_(link) {
  ARMSIG_CHECK(drives.count() == configuration.drawing.joints.size());
  commanded_.resize(drives.count());
}

void Servo::tick(hal::Duration lateness) {
  now_ = clock_.now();
  const Result<void> read = drives_.read(now_);
  read_torque();
  supervise(read, lateness);
  take_commands();
  step_mode();
  command_drives();
  publish(lateness);
}

void Servo::supervise(const Result<void>& read, hal::Duration lateness) {
  if (mode_ == Mode::kFaulted) {
    learn_the_reason();
    return;
  }
  if constexpr (!hal::kSmallImage) {
    if (mode_ == Mode::kStarting) {
      wait_for_drives(read);
      return;
    }
  }
  supervise_drives();
  if (!read) fail(read.error());
  if (has_torque() || enabling_) supervise_following();
  supervise_torque();
  if (has_torque() && lateness > configuration_.supervision.latest_tick) fail(Error::kLateTick);
}

// The drive that faulted first: the others have left their state because of it.
void Servo::supervise_drives() {
  for (std::size_t joint = 0; joint < drives_.count(); ++joint) {
    const hal::DriveStatus status = drives_.status(joint);
    if (status.condition != hal::DriveCondition::kFaulted && !status.fault) continue;
    fail(status.fault.value_or(Error::kDriveFault), joint, status.fault_code, status.words);
    if (fault_->joint != joint) continue;
    fault_->object = status.fault_object;
    fault_->details = status.fault_details;
  }
  for (std::size_t joint = 0; joint < drives_.count() && has_torque(); ++joint) {
    const hal::DriveStatus status = drives_.status(joint);
    if (status.condition != hal::DriveCondition::kEnabled && !is_homing(joint)) {
      fail(Error::kDriveDroppedOut, joint, status.status_word);
    }
  }
}

void Servo::supervise_following() {
  const JointVector& actual = drives_.positions();
  for (std::size_t joint = 0; joint < actual.size(); ++joint) {
    if (is_homing(joint)) continue;  // it follows no targets
    const double error = std::abs(commanded_[joint] - actual[joint]);
    if (!(error <= configuration_.supervision.following_error[joint])) {
      fail(Error::kFollowingError, joint);
    }
  }
}

// Of the drives that tell it, as their joints have a limit.
void Servo::read_torque() {
#ifndef ARMSIG_SMALL_IMAGE
  const auto& limits = configuration_.supervision.sequence_torque;
  for (std::size_t joint = 0; joint < limits.size(); ++joint) {
    if (limits[joint]) torque_[joint] = drives_.status(joint).torque;
  }
#endif
}

// An arm that touches something in a sequence is stopped by it long before it lags.
void Servo::supervise_torque() {
#ifndef ARMSIG_SMALL_IMAGE
  // What stands in the way takes torque for longer; a reading alone may be noise.
  constexpr hal::Duration kLasting = std::chrono::milliseconds(20);
  const auto& limits = configuration_.supervision.sequence_torque;
  for (std::size_t joint = 0; joint < limits.size(); ++joint) {
    const double torque = in_sequence_ && torque_[joint] ? std::abs(*torque_[joint]) : 0;
    largest_torque_[joint] = std::max(largest_torque_[joint], torque);
    if (!limits[joint] || !(torque > *limits[joint])) {
      torque_within_at_[joint] = now_;
    } else if (now_ - torque_within_at_[joint] >= kLasting) {
      fail(Error::kTorqueTooLarge, joint);
    }
  }
#endif
}

// The first cause is kept; what follows from it is not told.
void Servo::fail(Error error, std::optional<std::size_t> joint, std::uint32_t code,
                 std::string_view words) {
  if (mode_ == Mode::kFaulted) return;
  mode_ = Mode::kFaulted;
  fault_ = Fault{error, joint, code, words};
  enabling_ = in_sequence_ = false;
  move_.reset();
  if constexpr (hal::kMayHome) homing_.reset();
  drives_.quick_stop();
}

// A drive may be seen to be in its fault state before it says why.
void Servo::learn_the_reason() {
  if (!fault_->joint || fault_->code != 0) return;
  const hal::DriveStatus status = drives_.status(*fault_->joint);
  if (status.fault != fault_->error) return;
  fault_->code = status.fault_code;
  fault_->words = status.words;
  fault_->details = status.fault_details;
}

void Servo::take_commands() {
  while (const auto command = link_.commands.take()) {
    results_[command->serial % results_.size()] = {command->serial, take(*command)};
    handled_ = command->serial;
  }
}

std::optional<Error> Servo::take(const Command& command) {
  if (!modes_of(command.kind).contains(mode_)) return Error::kWrongMode;
  switch (command.kind) {
    case CommandKind::kEnable:
      if (enabling_ || !drives_.all(hal::DriveCondition::kDisabled)) return Error::kWrongMode;
      if (const auto enabled = drives_.enable(); !enabled) return enabled.error();
      enabling_ = true;
      break;
    case CommandKind::kDisable:
      disable();
      break;
    case CommandKind::kReset:
      drives_.reset_faults();
      fault_.reset();
      mode_ = Mode::kStarting;
      break;
    case CommandKind::kStop:
      fail(Error::kQuickStop);
      break;
    case CommandKind::kHalt:
      halt();
      break;
    case CommandKind::kMove:
      // The operator's halt may have come before the move of a sequence that does not know of it.
      if (command.of_sequence && !in_sequence_) return Error::kWrongMode;
      return begin(command.move);
    case CommandKind::kBeginSequence:
      begin_sequence();
      break;
    case CommandKind::kEndSequence:
      in_sequence_ = false;
      break;
    case CommandKind::kAdoptModel:
      if (move_) return Error::kWrongMode;
      model_ = command.index;  // commanded_ stays: the joints do not notice
      break;
    case CommandKind::kHome:
      return hal::kMayHome ? home(command.index) : Error::kUnsupported;
  }
  return std::nullopt;
}

void Servo::begin_sequence() {
  in_sequence_ = true;
#ifndef ARMSIG_SMALL_IMAGE
  largest_torque_.fill(0);
#endif
}

void Servo::halt() {
  in_sequence_ = false;
  path_.brake();
  if constexpr (hal::kMayHome) drives_.stop_homing();
}

void Servo::disable() {
  drives_.disable();
  enabling_ = in_sequence_ = false;
  move_.reset();
  if constexpr (hal::kMayHome) homing_.reset();
  mode_ = Mode::kIdle;
}

std::optional<Error> Servo::home(std::size_t joint) {
  if (move_) return Error::kWrongMode;
  if (const auto begun = drives_.home(joint); !begun) return begun.error();
  homing_ = joint;
  return std::nullopt;
}

// Its drive moves the joint by itself, and says at last that its reading is another.
void Servo::step_homing() {
  if (!homing_) return;
  commanded_[*homing_] = drives_.positions()[*homing_];
  if (drives_.status(*homing_).condition == hal::DriveCondition::kEnabled) homing_.reset();
}

std::optional<Error> Servo::begin(const Move& move) {
  if (move_) return Error::kWrongMode;
  for (std::size_t joint = 0; joint < commanded_.size(); ++joint) {
    if (std::abs(move.from[joint] - commanded_[joint]) > kSameReading) return Error::kWrongMode;
  }
  move_ = move;
  path_.begin(move.duration_s, hal::seconds(configuration_.period));
  return std::nullopt;
}

void Servo::step_mode() {
  using enum hal::DriveCondition;
  if (mode_ == Mode::kStarting && drives_.all(kDisabled)) {
    mode_ = Mode::kIdle;
    if constexpr (!hal::kSmallImage) fault_.reset();
    publish_machine();
  }
  if (!has_torque()) follow_positions();
  if (enabling_ && drives_.all(kEnabled)) {
    enabling_ = false;
    mode_ = Mode::kHolding;
    unsettled_at_ = now_;
  }
  if (!has_torque()) return;
  step_move();
  if (!has_torque()) return;  // the move failed
  if constexpr (hal::kMayHome) step_homing();
  mode_ = in_sequence_ ? Mode::kSweeping : (move_ ? Mode::kServoing : Mode::kHolding);
  if (hal::kMayHome && homing_) mode_ = Mode::kHoming;
  if (!is_settled()) unsettled_at_ = now_;
}

// A joint without torque is commanded to be where it is. One that has torque before the others
// stays where it was: it would follow its own shaft.
void Servo::follow_positions() {
  const JointVector& actual = drives_.positions();
  for (std::size_t joint = 0; joint < actual.size(); ++joint) {
    if (!(enabling_ && drives_.status(joint).has_torque)) commanded_[joint] = actual[joint];
  }
}

void Servo::publish_machine() {
  publish_gaps();
  const auto machine = machine_of(configuration_.drawing, drives_);
  if (!machine) return;
  link_.machine.writing() = *machine;
  link_.machine.publish();
}

void Servo::publish_gaps() {
  auto& gaps = link_.gaps.writing();
  gaps.clear();
  for (std::size_t joint = 0; joint < drives_.count(); ++joint) {
    for (std::size_t number = 0; !gaps.full(); ++number) {
      const auto gap = drives_.gap(joint, number);
      if (!gap) break;
      gaps.push_back({static_cast<std::uint8_t>(joint), *gap});
    }
  }
  link_.gaps.publish();
}

void Servo::step_move() {
  if (!move_) return;
  const auto q = readings_at(*move_, configuration_, link_.models[model_], commanded_,
                             path_.advance(move_->braking), lately_);
  if (!q) {
    fail(q.error());
    return;
  }
  commanded_ = *q;
  if (path_.at_rest()) move_.reset();
}

bool Servo::is_settled() const {
  if (move_) return false;
  const JointVector& actual = drives_.positions();
  for (std::size_t joint = 0; joint < actual.size(); ++joint) {
    if (std::abs(commanded_[joint] - actual[joint]) > configuration_.dwell.tolerance) return false;
  }
  return true;
}

void Servo::command_drives() {
  const auto written = drives_.write(commanded_, now_);
  // One full queue is the bus's business: the backend faults if it stays full.
  if (written || !has_torque() || written.error() == Error::kBusBusy) return;
  if constexpr (!hal::kSmallImage) supervise_drives();  // a drive may say which bus it is
  fail(written.error());
}

// Where every position is known.
void Servo::publish_tool(Snapshot& out) const {
  out.X_RT.reset();
  if (out.known != (1U << drives_.count()) - 1) return;
  if (const auto X_RT = tool_pose(link_.models[model_], out.positions)) out.X_RT = *X_RT;
}

void Servo::publish_torque([[maybe_unused]] Snapshot& out) const {
#ifndef ARMSIG_SMALL_IMAGE
  out.torque = torque_;
  out.largest_torque = largest_torque_;
#endif
}

void Servo::publish(hal::Duration lateness) {
  Snapshot& out = link_.snapshot.writing();
  out.mode = mode_;
  out.fault = fault_;
  out.handled = handled_;
  out.results = results_;
  out.positions = drives_.positions();
  out.commanded = commanded_;
  out.moving = move_.has_value();
  out.left_s = move_ ? path_.left_s() : 0;
  out.settled = has_torque() ? now_ - unsettled_at_ : hal::Duration::zero();
  out.now = now_;
  out.model = model_;
  out.all_disabled = drives_.all(hal::DriveCondition::kDisabled);
  out.status_words.clear();
  out.limits_active = out.warning = out.unsupervised = out.known = out.homing = out.homed = 0;
  for (std::size_t joint = 0; joint < drives_.count(); ++joint) {
    const hal::DriveStatus status = drives_.status(joint);
    out.status_words.push_back(status.status_word);
    const auto bit = static_cast<std::uint8_t>(1U << joint);
    if (status.limit_active) out.limits_active |= bit;
    if (status.warning) out.warning |= bit;
    if (status.unsupervised) out.unsupervised |= bit;
    if (status.has_position) out.known |= bit;
    if (is_homing(joint)) {
      out.homing |= bit;
    } else if (hal::kMayHome && status.homed) {
      out.homed |= bit;
    }
  }
  if constexpr (!hal::kSmallImage) publish_words();
  publish_torque(out);
  publish_tool(out);
  lateness_.add(lateness);
  out.lateness = lateness_;
  execution_.add(clock_.now() - now_);
  out.execution = execution_;
  if (link_.observer != nullptr) link_.observer->take(out, lateness);
  link_.snapshot.publish();
}

}  // namespace armsig::controller
