// SPDX-License-Identifier: MIT
#include "hal/cia402/drive.hpp"

#include <algorithm>
#include <cmath>

#include "hal/cia402/standstill.hpp"

namespace armsig::cia402 {
namespace {

// A target may be this much faster than the joint's largest speed, for the rounding of planners and
// the lateness of ticks; and at most this many periods may be made up for after missed writes.
constexpr double kTargetMargin = 1.25;
constexpr double kTargetPeriods = 4;
// A position may change this many times faster than the largest speed before it is disbelieved:
// a drive that overshoots or is pushed stays below, a bit error does not.
constexpr double kFeedbackMargin = 4;
// Stamps of a loaded host are late by milliseconds.
constexpr double kLateStamp_s = 2e-3;

// For a drive to take its torque off before it is set up anew all the same.
constexpr hal::Duration kLongestRelease = std::chrono::milliseconds(200);

}  // namespace

hal::DriveStatus Drive::status() const {
  hal::DriveStatus status{.fault = s_.fault,
                          .fault_code = s_.fault_code,
                          .fault_object = s_.fault_object,
                          .words = {},
                          .status_word = s_.status_word,
                          .limit_active = (s_.status_word & kStatusInternalLimit) != 0,
                          .warning = (s_.status_word & kStatusWarning) != 0,
                          .has_torque = has_torque(s_.state),
                          .has_position = s_.heard,
                          .homed = s_.homed,
                          .torque = s_.torque,
                          .information = 0};
  using enum hal::DriveCondition;
  if (s_.fault) {
    status.condition = kFaulted;
  } else if (!s_.heard || s_.leaving) {
    status.condition = kStarting;
  } else if (is_homing()) {
    status.condition = s_.goal == Goal::kEnabled ? kHoming : kSwitching;
  } else if (!reached(s_.goal, s_.state) || (is_enabled() && !s_.arrived)) {
    status.condition = kSwitching;
  } else if (s_.goal == Goal::kEnabled) {
    status.condition = kEnabled;
  } else if (s_.goal == Goal::kStopped) {
    status.condition = s_.stands ? kStopped : kStopping;
  } else {
    status.condition = kDisabled;
  }
  return status;
}

void Drive::hear(std::uint16_t status_word, std::int32_t counts, hal::Instant at) {
  const double position = scaling_.reading(counts);
  // A drive that finds its reference counts from there on.
  if (s_.heard && s_.goal == Goal::kEnabled && !is_homing()) {
    const double elapsed = std::max(0.0, hal::seconds(at - s_.position_at)) + kLateStamp_s;
    if (std::fabs(position - s_.position) >
        kFeedbackMargin * settings_->largest_speed * elapsed + 2 * scaling_.resolution()) {
      latch(Error::kFeedbackImplausible);
    }
  }
  s_.status_word = status_word;
  const State state = decode_state(status_word);
  if (state != s_.state) s_.progress_at = at;
  s_.state = state;
  s_.actual_counts = counts;
  s_.position = position;
  s_.position_at = at;
  take_rest(at);
  if (!s_.heard) {
    s_.heard = true;
    s_.progress_at = at;
    s_.target = position;
  }
}

void Drive::hear_torque([[maybe_unused]] std::int16_t per_mille) {
#ifndef ARMSIG_SMALL_IMAGE
  s_.torque = per_mille / 1000.0;
#endif
}

void Drive::forget() {
  s_.heard = false;
  s_.torque = {};
  s_.hides_mode = false;
  s_.state = State::kNotReadyToSwitchOn;
  s_.leaving = false;
  s_.stands = true;
  s_.homing = Homing::kNone;
  s_.homed = false;
}

void Drive::set_goal(Goal goal, hal::Instant now) {
  if (goal == s_.goal) return;
  s_.goal = goal;
  s_.progress_at = now;
  s_.arrived = false;
  if constexpr (hal::kMayHome) leave_homing(now);
}

void Drive::latch(Error error, std::uint32_t code, const hal::DeviceObject& object) {
  if (s_.fault || s_.leaving) return;
  s_.fault = error;
  s_.fault_code = code;
  s_.fault_object = object;
  s_.resetting = false;
}

void Drive::explain(std::uint32_t code) {
  if (s_.fault == Error::kDriveFault && s_.fault_code == 0) s_.fault_code = code;
}

void Drive::reset(hal::Instant now) {
  s_.resetting = true;  // until a state other than Fault is seen; also after a new set-up
  s_.reset_bit = false;
  s_.fault.reset();
  s_.fault_code = 0;
  s_.fault_object = {};
  s_.progress_at = now;
}

void Drive::leave(bool rebooted) {
  s_.leaving = true;
  s_.released_at.reset();
  if (rebooted) s_.state = State::kNotReadyToSwitchOn;
}

// The controlword takes the torque off first, as the drive then keeps it until its brake has
// closed.
bool Drive::has_let_go(hal::Instant now) {
  if (!s_.leaving) return false;
  if (!s_.released_at) s_.released_at = now;
  const bool listens = now - s_.position_at <= kFreshPosition;
  return !has_torque(s_.state) || !listens || now - *s_.released_at > kLongestRelease;
}

Result<void> Drive::set_target(double target, bool group_enabled, hal::Duration period,
                               hal::Instant now) {
  if (!std::isfinite(target)) return std::unexpected(Error::kNotFinite);
  if (!is_enabled() || !group_enabled) {
    if (!is_enabled()) s_.target = s_.position;
    s_.target_at = now;
    return {};
  }
  const JointLimits& limits = settings_->limits;
  // A joint that was enabled outside its limits may be held there and brought back.
  if (target < std::min(limits.lower, s_.target) || target > std::max(limits.upper, s_.target)) {
    return std::unexpected(Error::kJointLimit);
  }
  const double elapsed = std::clamp(hal::seconds(now - s_.target_at), hal::seconds(period),
                                    kTargetPeriods * hal::seconds(period));
  if (std::fabs(target - s_.target) >
      kTargetMargin * settings_->largest_speed * elapsed + 2 * scaling_.resolution()) {
    return std::unexpected(Error::kTargetStep);
  }
  // A motion that begins is seen in the targets before it is seen in the positions.
  if (std::fabs(target - s_.target) > scaling_.resolution()) s_.moved_at = now;
  s_.target = target;
  s_.target_at = now;
  return {};
}

Setpoint Drive::command(bool may_release) {
  s_.held = !may_release && s_.state == State::kQuickStopActive;
  std::uint16_t word = control_word(next_step(s_.goal, s_.state, may_release).command);
  if (s_.resetting && s_.state == State::kFault && may_release) {
    // The reset acts on the bit's rising edge; a drive that missed it is given another.
    s_.reset_bit = !s_.reset_bit;
    if (s_.reset_bit) word = control_word(Command::kFaultReset);
  }
  if (is_homing() && s_.homing == Homing::kSearching && s_.state == State::kOperationEnabled) {
    word |= kControlHomingStart;
  }
  // A disabled drive is sent its own count back, exactly. Limits were checked to fit into counts,
  // and a position outside them came from counts.
  const std::int32_t counts =
      is_enabled() ? scaling_.counts(s_.target).value_or(s_.actual_counts) : s_.actual_counts;
  const PositionMode mode = settings_->position_mode();
  if (mode == PositionMode::kProfile) return offer({word, counts});
  if (mode == PositionMode::kInterpolated && is_enabled()) word |= kControlInterpolate;
  return {word, counts};
}

// The drive latches the target at the rising edge, and tells by bit 12 that it has: the offer then
// ends, and after that bit the next may begin. Targets that change meanwhile are passed over.
Setpoint Drive::offer(Setpoint wanted) {
  if (!is_enabled()) {
    s_.offers = false;
    s_.taken = false;
    s_.offered_counts = wanted.target_counts;
    return wanted;
  }
  const bool takes = (s_.status_word & kStatusTargetTaken) != 0;
  if (s_.offers && takes) {
    s_.offers = false;
    s_.taken = true;
  } else if (!s_.offers && !takes && (!s_.taken || s_.offered_counts != wanted.target_counts)) {
    s_.offers = true;
    s_.offered_counts = wanted.target_counts;
  }
  wanted.control_word |= kControlAtOnce;
  if (s_.offers) wanted.control_word |= kControlNewTarget;
  wanted.target_counts = s_.offered_counts;
  return wanted;
}

}  // namespace armsig::cia402
