// SPDX-License-Identifier: MIT
#include "hal/canopen/drive_node.hpp"

#include <algorithm>
#include <cmath>

#include "hal/canopen/emergency.hpp"
#include "hal/canopen/sdo_client.hpp"
#include "hal/canopen/standstill.hpp"

namespace armsig::canopen {
namespace {

using cia402::Goal;
using cia402::State;

// A target may be this much faster than the joint's largest speed, for the rounding of planners and
// the lateness of ticks; and at most this many periods may be made up for after missed writes.
constexpr double kTargetMargin = 1.25;
constexpr double kTargetPeriods = 4;
// A position may change this many times faster than the largest speed before it is disbelieved:
// a drive that overshoots or is pushed stays below, a bit error does not.
constexpr double kFeedbackMargin = 4;

// For a drive to take its torque off before it is reset by NMT all the same.
constexpr hal::Duration kLongestRelease = std::chrono::milliseconds(200);

// A drive that boots more often than this after one reset does not stay up.
constexpr unsigned kMostBootUps = 3;

// Faults after which the drive's own settings are in doubt, so that it must be set up again.
// Another master may have changed any of them, or reset the drive.
bool needs_setup(Error fault) {
  switch (fault) {
    case Error::kDriveEmergency:
    case Error::kDriveFault:
    case Error::kDriveDroppedOut:
    case Error::kTransitionTimeout:
    case Error::kFeedbackImplausible:
    case Error::kBusBusy:
    case Error::kTargetsIgnored:
    case Error::kDriveLimited:
    case Error::kDriveLags:
    case Error::kDriveWarning:
    case Error::kVoltageLost:
    case Error::kStopTimeout:
      return false;
    default:
      return true;
  }
}

std::string_view words_of(std::optional<Error> fault, std::uint32_t code) {
  if (!fault || code == 0) return {};
  if (*fault == Error::kSdoAborted) return describe_sdo_abort(code);
  if (*fault == Error::kScaleInvalid) {
    return "this object says that the drive counts otherwise than configured";
  }
  const bool emergency = *fault == Error::kDriveEmergency || *fault == Error::kDriveFault;
  return emergency ? describe_emergency(static_cast<std::uint16_t>(code)) : std::string_view();
}

}  // namespace

hal::DriveStatus DriveNode::status() const {
  hal::DriveStatus status{.fault = s_.fault,
                          .fault_code = s_.fault_code,
                          .words = words_of(s_.fault, s_.fault_code),
                          .status_word = s_.status_word,
                          .limit_active = (s_.status_word & cia402::kStatusInternalLimit) != 0,
                          .warning = (s_.status_word & cia402::kStatusWarning) != 0,
                          .has_torque = cia402::has_torque(s_.state),
                          .information = s_.information};
  using enum hal::DriveCondition;
  if (s_.fault) {
    status.condition = kFaulted;
  } else if (s_.phase != Phase::kRunning || s_.set_up_again) {
    status.condition = kStarting;
  } else if (!cia402::reached(s_.goal, s_.state) || (is_enabled() && !s_.arrived)) {
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

void DriveNode::enter(Phase phase, hal::Instant now) {
  s_.phase = phase;
  s_.phase_since = now;
  if (phase == Phase::kUnreset) {
    s_.boot_ups = 0;
    s_.state = State::kNotReadyToSwitchOn;
    s_.set_up_again = false;
    s_.stands = true;
  }
  if (phase == Phase::kStarted) {
    s_.heard_at = now;
    s_.heard_operational = false;
    s_.missed = 0;
    s_.answered = false;
    s_.sync_unanswered = false;
  }
}

void DriveNode::set_goal(Goal goal, hal::Instant now) {
  if (goal == s_.goal) return;
  s_.goal = goal;
  s_.progress_at = now;
  s_.arrived = false;
}

void DriveNode::latch(Error error, std::uint32_t code) {
  if (s_.fault || s_.set_up_again) return;
  s_.fault = error;
  s_.fault_code = code;
  s_.resetting = false;
}

void DriveNode::reset(hal::Instant now) {
  if (s_.phase == Phase::kFailed) {
    enter(Phase::kUnreset, now);
  } else if (s_.fault && needs_setup(*s_.fault)) {
    s_.set_up_again = true;
    s_.released_at.reset();
    if (*s_.fault == Error::kDriveRebooted) s_.state = State::kNotReadyToSwitchOn;
  }
  s_.resetting = true;  // until a state other than Fault is seen; also after a new set-up
  s_.reset_bit = false;
  s_.fault.reset();
  s_.fault_code = 0;
  s_.missed = 0;
  s_.progress_at = now;
}

// The controlword takes the torque off first, as the drive then keeps it until its brake has
// closed.
void DriveNode::release(hal::Instant now) {
  if (!s_.set_up_again) return;
  if (!s_.released_at) s_.released_at = now;
  const bool listens = now - s_.position_at <= kFreshPosition;
  if (cia402::has_torque(s_.state) && listens && now - *s_.released_at <= kLongestRelease) return;
  enter(Phase::kUnreset, now);
}

bool DriveNode::take_feedback(const hal::ReceivedCanFrame& received) {
  if (received.frame.length != kDrivePdoBytes) return false;
  if (!is_started()) return true;
  const auto counts = static_cast<std::int32_t>(load<std::uint32_t>(received.frame, 2));
  const double position = scaling_.reading(counts);
  if (s_.phase == Phase::kRunning && s_.goal == Goal::kEnabled) {
    const double elapsed = std::max(0.0, hal::seconds(received.at - s_.position_at)) +
                           2e-3;  // stamps of a loaded host are late by milliseconds
    if (std::fabs(position - s_.position) >
        kFeedbackMargin * axis_->largest_speed * elapsed + 2 * scaling_.resolution()) {
      latch(Error::kFeedbackImplausible);
    }
  }
  s_.status_word = load<std::uint16_t>(received.frame, 0);
  const State state = cia402::decode_state(s_.status_word);
  if (state != s_.state) s_.progress_at = received.at;
  s_.state = state;
  s_.actual_counts = counts;
  s_.position = position;
  s_.position_at = received.at;
  s_.answered = true;
  take_rest(received.at);
  if (s_.phase == Phase::kStarted) {
    enter(Phase::kRunning, received.at);
    s_.progress_at = received.at;
    s_.target = position;
  }
  return true;
}

bool DriveNode::take_heartbeat(const hal::CanFrame& frame, hal::Instant now) {
  if (frame.length != 1) return false;
  const auto state = static_cast<NmtState>(frame.data[0] & 0x7FU);
  s_.heard_at = now;
  if (state == NmtState::kBootUp) {
    if (is_started()) {
      latch(Error::kDriveRebooted);
    } else if (s_.phase != Phase::kUnreset && s_.phase != Phase::kFailed) {
      // The boot-up message of the power-up may cross with our reset, whose own then comes in the
      // middle of the set-up: it begins anew.
      if (++s_.boot_ups > kMostBootUps) latch(Error::kDriveRebooted);
      enter(Phase::kBooted, now);
    }
  } else if (state == NmtState::kOperational) {
    s_.heard_operational = true;
  } else if (s_.phase == Phase::kRunning) {
    // The first TPDO1 overtakes a heartbeat that the drive had queued before it was started.
    const bool overtaken =
        !s_.heard_operational && state == NmtState::kPreOperational && s_.goal != Goal::kEnabled;
    s_.heard_operational = true;
    if (!overtaken) latch(Error::kDriveNotOperational, frame.data[0]);
  }
  return true;
}

bool DriveNode::take_emergency(const hal::CanFrame& frame) {
  const auto emergency = decode_emergency(frame);
  if (!emergency) return false;
  // What a device says while it boots is about the time before; "no error" ends nothing, because a
  // fault is forgotten by the operator only.
  if (emergency->code == 0 || !is_started()) return true;
  if (is_information(*emergency)) {
    s_.information = emergency->code;
    return true;
  }
  latch(Error::kDriveEmergency, emergency->code);
  // A drive may tell its state before the reason.
  if (s_.fault == Error::kDriveFault && s_.fault_code == 0) s_.fault_code = emergency->code;
  return true;
}

Result<void> DriveNode::set_target(double target, bool group_enabled, hal::Duration period,
                                   hal::Instant now) {
  if (!std::isfinite(target)) return std::unexpected(Error::kNotFinite);
  if (!is_enabled() || !group_enabled) {
    if (!is_enabled()) s_.target = s_.position;
    s_.target_at = now;
    return {};
  }
  const JointLimits& limits = axis_->limits;
  // A joint that was enabled outside its limits may be held there and brought back.
  if (target < std::min(limits.lower, s_.target) || target > std::max(limits.upper, s_.target)) {
    return std::unexpected(Error::kJointLimit);
  }
  const double elapsed = std::clamp(hal::seconds(now - s_.target_at), hal::seconds(period),
                                    kTargetPeriods * hal::seconds(period));
  if (std::fabs(target - s_.target) >
      kTargetMargin * axis_->largest_speed * elapsed + 2 * scaling_.resolution()) {
    return std::unexpected(Error::kTargetStep);
  }
  // A motion that begins is seen in the targets before it is seen in the positions.
  if (std::fabs(target - s_.target) > scaling_.resolution()) s_.moved_at = now;
  s_.target = target;
  s_.target_at = now;
  return {};
}

hal::CanFrame DriveNode::command(bool may_release) {
  s_.held = !may_release && s_.state == State::kQuickStopActive;
  std::uint16_t word =
      cia402::control_word(cia402::next_step(s_.goal, s_.state, may_release).command);
  if (s_.resetting && s_.state == State::kFault && may_release) {
    // The reset acts on the bit's rising edge; a drive that missed it is given another.
    s_.reset_bit = !s_.reset_bit;
    if (s_.reset_bit) word = cia402::control_word(cia402::Command::kFaultReset);
  }
  // A disabled drive is sent its own count back, exactly. Limits were checked to fit into counts,
  // and a position outside them came from counts.
  const std::int32_t counts =
      is_enabled() ? scaling_.counts(s_.target).value_or(s_.actual_counts) : s_.actual_counts;
  hal::CanFrame frame{.id = kReceivePdo1Id + axis_->node, .length = kDrivePdoBytes};
  store(frame, 0, word);
  store(frame, 2, static_cast<std::uint32_t>(counts));
  return frame;
}

}  // namespace armsig::canopen
