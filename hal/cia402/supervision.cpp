// SPDX-License-Identifier: MIT
// What a drive is watched for in every tick: whether it stands, keeps its state, and what its
// statusword says.
#include <algorithm>
#include <cmath>

#include "hal/cia402/drive.hpp"
#include "hal/cia402/standstill.hpp"

namespace armsig::cia402 {
namespace {

// Bits of the statusword that an enabled drive must keep as they are in `well`.
struct StatusRule {
  std::uint16_t mask;
  std::uint16_t well;
  Error error;
  hal::Duration StatusLimits::* limit;
};
constexpr std::array<StatusRule, kStatusRules> kRules{{
    {kStatusVoltage, kStatusVoltage, Error::kVoltageLost, &StatusLimits::no_voltage},
    {kStatusFollowingError, 0, Error::kDriveLags, &StatusLimits::lags},
    {kStatusFollowsTarget, kStatusFollowsTarget, Error::kTargetsIgnored, &StatusLimits::ignores},
    {kStatusInternalLimit, 0, Error::kDriveLimited, &StatusLimits::limits},
    {kStatusWarning, 0, Error::kDriveWarning, &StatusLimits::warns},
}};

}  // namespace

// A joint that is seen for the first time is taken to stand: it has no torque by us.
void Drive::take_rest(hal::Instant at) {
  const double tolerance = rest_tolerance(settings_->scaling.type, scaling_);
  if (!s_.heard) {
    s_.rest_position = s_.position;
    s_.moved_at = at - kRestTime;
  } else if (std::fabs(s_.position - s_.rest_position) > tolerance) {
    s_.rest_position = s_.position;
    s_.moved_at = at;
  }
  if (s_.state == State::kQuickStopActive && (s_.status_word & kStatusTargetReached) != 0) {
    s_.tells_rest = true;
  }
}

void Drive::update_rest(hal::Duration period, hal::Instant now) {
  const hal::Duration fresh = std::max(kFreshPosition, kFreshPeriods * period);
  const bool told_moving = s_.tells_rest && s_.state == State::kQuickStopActive &&
                           (s_.status_word & kStatusTargetReached) == 0;
  s_.stands = !s_.heard ||
              (now - s_.position_at <= fresh && now - s_.moved_at >= kRestTime && !told_moving);
}

void Drive::supervise(const GroupSettings& settings, hal::Instant now) {
  update_rest(settings.period, now);
  if (s_.heard && !s_.leaving) check_state(settings, now);
}

void Drive::check_state(const GroupSettings& settings, hal::Instant now) {
  const bool in_fault = s_.state == State::kFault || s_.state == State::kFaultReactionActive;
  if (in_fault) {
    if (!s_.resetting || now - s_.progress_at > settings.transition_timeout) {
      latch(Error::kDriveFault);
    }
    return;
  }
  s_.resetting = false;
  if (s_.held) s_.progress_at = now;  // takes the time of its ramp, or of the others'
  check_status_word(settings.status_limits, now);
  if constexpr (hal::kMayHome) check_homing(settings, now);
  if (reached(s_.goal, s_.state)) {
    // A drive whose brake is still opening does not follow yet.
    s_.arrived = s_.arrived || s_.goal != Goal::kEnabled || (follows() && !s_.hides_mode);
  } else if (s_.arrived && s_.goal == Goal::kEnabled) {
    latch(Error::kDriveDroppedOut, s_.status_word);
  } else if (now - s_.progress_at > settings.transition_timeout) {
    latch(Error::kTransitionTimeout, s_.status_word);
  }
}

bool Drive::follows() const {
  if (settings_->position_mode() == PositionMode::kProfile) return s_.taken;
  return (s_.status_word & kStatusFollowsTarget) != 0;
}

// Whether the statusword is as a rule wants it, in this mode. Bits 12 and 13 mean nothing before
// the drive has shown it. Where it makes profiles, bit 12 is the answer to an offer; where it
// interpolates, bit 13 has no meaning.
bool Drive::keeps_in_mode(std::uint16_t mask, std::uint16_t well) const {
  const PositionMode mode = settings_->position_mode();
  const bool of_mode = mask == kStatusFollowsTarget || mask == kStatusFollowingError;
  if (of_mode && s_.hides_mode) return true;
  if (mode == PositionMode::kInterpolated && mask == kStatusFollowingError) return true;
  if (mode == PositionMode::kProfile && mask == kStatusFollowsTarget) {
    return ((s_.status_word & kStatusTargetTaken) != 0) == s_.offers;
  }
  return (s_.status_word & mask) == well;
}

void Drive::check_status_word(const StatusLimits& limits, hal::Instant now) {
  for (std::size_t i = 0; i < kRules.size(); ++i) {
    const StatusRule& rule = kRules[i];
    const bool known = rule.error == Error::kDriveWarning && settings_->warning_known;
    const bool kept = hal::kOtherModes ? keeps_in_mode(rule.mask, rule.well)
                                       : (s_.status_word & rule.mask) == rule.well;
    if (known || !is_enabled() || kept) {
      s_.well_at[i] = now;
    } else if (now - s_.well_at[i] > limits.*rule.limit) {
      latch(rule.error, s_.status_word);
    }
  }
}

}  // namespace armsig::cia402
