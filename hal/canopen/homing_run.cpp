// SPDX-License-Identifier: MIT
#include "hal/canopen/homing_run.hpp"

namespace armsig::canopen {
namespace {

using cia402::Homing;

constexpr SdoRequest kEnterMode{
    .index = cia402::kModeOfOperation, .bytes = 1, .value = cia402::kModeHoming};
constexpr SdoRequest kShownMode{.index = cia402::kModeDisplay};

SdoRequest method_request(std::int8_t method) {
  return {.index = cia402::kHomingMethod, .bytes = 1, .value = static_cast<std::uint8_t>(method)};
}

}  // namespace

HomingRun::HomingRun(const Configuration& configuration, std::size_t joint)
    : configuration_(configuration), joint_(joint) {
  enter(configuration.axes[joint].homing_method ? Step::kMethod : Step::kEnter);
}

void HomingRun::ask(const SdoRequest& request) {
  const AxisConfiguration& axis = configuration_.axes[joint_];
  request_ = request;
  request_.index = axis.object(request.index);
  transfer_.emplace(axis.node, request_, configuration_.sdo_timeout, configuration_.sdo_attempts);
}

void HomingRun::enter(Step step) {
  step_ = step;
  transfer_.reset();
  if (step == Step::kMethod) ask(method_request(*configuration_.axes[joint_].homing_method));
  if (step == Step::kEnter) ask(kEnterMode);
  if (step == Step::kLook) ask(kShownMode);
  if (step == Step::kLeave) {
    const auto mode = configuration_.axes[joint_].position_mode();
    ask({.index = cia402::kModeOfOperation, .bytes = 1, .value = static_cast<std::uint32_t>(mode)});
  }
}

void HomingRun::take(const hal::CanFrame& frame) {
  if (transfer_) transfer_->take(frame);
}

std::optional<hal::CanFrame> HomingRun::poll(cia402::Drive& drive, hal::Instant now) {
  if (drive.state().homing == Homing::kLeaving && step_ < Step::kStand) enter(Step::kStand);
  if (step_ == Step::kStand) wait_for_standstill(drive, now);
  if (transfer_ && transfer_->outcome()) hear(SdoOutcome(*transfer_->outcome()), drive, now);
  return transfer_ ? transfer_->poll(now) : std::nullopt;
}

// A change of the mode in motion would end it by no ramp of ours.
void HomingRun::wait_for_standstill(cia402::Drive& drive, hal::Instant now) {
  const auto& state = drive.state();
  const bool too_long = now - state.progress_at > configuration_.stop_timeout;
  if (!state.stands && !too_long) return;
  if (!state.stands) drive.latch(Error::kStopTimeout);
  enter(Step::kLeave);
}

void HomingRun::hear(const SdoOutcome& outcome, cia402::Drive& drive, hal::Instant now) {
  if (!outcome) {
    drive.latch(outcome.error().error, outcome.error().abort_code,
                {.index = request_.index,
                 .subindex = request_.subindex,
                 .found = {},
                 .wanted = request_.value});
    drive.leave_homing(now);
  }
  if (step_ == Step::kLeave) {
    drive.end_homing(now);
    enter(Step::kOver);
  } else if (!outcome) {
    enter(Step::kStand);
  } else if (step_ == Step::kMethod) {
    enter(Step::kEnter);
  } else if (step_ == Step::kEnter) {
    enter(Step::kLook);
  } else if (step_ == Step::kLook) {
    look(*outcome & 0xFFU, drive, now);
  }
}

void HomingRun::look(std::uint32_t mode, cia402::Drive& drive, hal::Instant now) {
  if (mode == cia402::kModeHoming) {
    drive.search(now);
    enter(Step::kSearch);
  } else if (now - drive.state().progress_at <= configuration_.transition_timeout) {
    enter(Step::kLook);
  } else {
    drive.latch(Error::kSdoUnexpectedValue, mode,
                {.index = configuration_.axes[joint_].object(cia402::kModeDisplay),
                 .subindex = 0,
                 .found = mode,
                 .wanted = cia402::kModeHoming});
    drive.leave_homing(now);
  }
}

}  // namespace armsig::canopen
