// SPDX-License-Identifier: MIT
// What a drive is watched for in every tick: whether it stands, answers, keeps its state, and what
// its statusword says.
#include <algorithm>
#include <cmath>

#include "hal/canopen/drive_node.hpp"
#include "hal/canopen/standstill.hpp"

namespace armsig::canopen {
namespace {

using cia402::Goal;
using cia402::State;

// Bits of the statusword that an enabled drive must keep as they are in `well`.
struct StatusRule {
  std::uint16_t mask;
  std::uint16_t well;
  Error error;
  hal::Duration StatusLimits::* limit;
};
constexpr std::array<StatusRule, kStatusRules> kRules{{
    {cia402::kStatusVoltage, cia402::kStatusVoltage, Error::kVoltageLost,
     &StatusLimits::no_voltage},
    {cia402::kStatusFollowingError, 0, Error::kDriveLags, &StatusLimits::lags},
    {cia402::kStatusFollowsTarget, cia402::kStatusFollowsTarget, Error::kTargetsIgnored,
     &StatusLimits::ignores},
    {cia402::kStatusInternalLimit, 0, Error::kDriveLimited, &StatusLimits::limits},
    {cia402::kStatusWarning, 0, Error::kDriveWarning, &StatusLimits::warns},
}};

}  // namespace

// A joint that is seen for the first time is taken to stand: it has no torque by us.
void DriveNode::take_rest(hal::Instant at) {
  const double tolerance = rest_tolerance(axis_->scaling.type, scaling_);
  if (s_.phase == Phase::kStarted) {
    s_.rest_position = s_.position;
    s_.moved_at = at - kRestTime;
  } else if (std::fabs(s_.position - s_.rest_position) > tolerance) {
    s_.rest_position = s_.position;
    s_.moved_at = at;
  }
  if (s_.state == State::kQuickStopActive && (s_.status_word & cia402::kStatusTargetReached) != 0) {
    s_.tells_rest = true;
  }
}

void DriveNode::update_rest(hal::Duration period, hal::Instant now) {
  const hal::Duration fresh = std::max(kFreshPosition, kFreshPeriods * period);
  const bool told_moving = s_.tells_rest && s_.state == State::kQuickStopActive &&
                           (s_.status_word & cia402::kStatusTargetReached) == 0;
  s_.stands = s_.phase != Phase::kRunning ||
              (now - s_.position_at <= fresh && now - s_.moved_at >= kRestTime && !told_moving);
}

void DriveNode::supervise(const Configuration& configuration, bool sync_sent, hal::Instant now) {
  if (!is_started()) return;
  update_rest(configuration.period, now);
  if (s_.set_up_again) return;
  if (now - s_.heard_at > configuration.heartbeat_timeout) latch(Error::kHeartbeatLost);
  if (s_.answered) {
    s_.missed = 0;
  } else if (s_.sync_unanswered) {
    ++s_.missed;
  }
  s_.answered = false;
  s_.sync_unanswered = sync_sent;
  if (s_.phase == Phase::kStarted) {
    if (now - s_.phase_since > configuration.boot_timeout) latch(Error::kFeedbackLost);
    return;
  }
  if (s_.missed >= configuration.missed_feedback_limit) latch(Error::kFeedbackLost);
  check_state(configuration, now);
}

void DriveNode::check_state(const Configuration& configuration, hal::Instant now) {
  const bool in_fault = s_.state == State::kFault || s_.state == State::kFaultReactionActive;
  if (in_fault) {
    if (!s_.resetting || now - s_.progress_at > configuration.transition_timeout) {
      latch(Error::kDriveFault);
    }
    return;
  }
  s_.resetting = false;
  if (s_.held) s_.progress_at = now;  // takes the time of its ramp, or of the others'
  check_status_word(configuration.status_limits, now);
  if (cia402::reached(s_.goal, s_.state)) {
    // A drive whose brake is still opening does not follow yet.
    const bool follows = (s_.status_word & cia402::kStatusFollowsTarget) != 0;
    s_.arrived = s_.arrived || s_.goal != Goal::kEnabled || follows;
  } else if (s_.arrived && s_.goal == Goal::kEnabled) {
    latch(Error::kDriveDroppedOut);
  } else if (now - s_.progress_at > configuration.transition_timeout) {
    latch(Error::kTransitionTimeout);
  }
}

void DriveNode::check_status_word(const StatusLimits& limits, hal::Instant now) {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    const StatusRule& rule = kRules[i];
    const bool well = !is_enabled() || (s_.status_word & rule.mask) == rule.well;
    if (well) {
      s_.well_at[i] = now;
    } else if (now - s_.well_at[i] > limits.*rule.limit) {
      latch(rule.error, s_.status_word);
    }
  }
}

}  // namespace armsig::canopen
