// SPDX-License-Identifier: MIT
#include "hal/canopen/drive_node.hpp"

#include "hal/canopen/emergency.hpp"
#include "hal/canopen/sdo_client.hpp"

namespace armsig::canopen {
namespace {

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

// Where a drive stays, or went, and what keeps drives there as a rule.
std::string_view words_of_state(std::uint16_t status_word) {
  using enum cia402::State;
  switch (cia402::decode_state(status_word)) {
    case kNotReadyToSwitchOn:
      return "Not ready to switch on: it starts, or tests itself";
    case kSwitchOnDisabled:
      return "Switch on disabled: safe torque off is open, or no supply";
    case kReadyToSwitchOn:
      return "Ready to switch on: no supply of the power stage";
    case kSwitchedOn:
      return "Switched on: its enable input is open";
    case kQuickStopActive:
      return "Quick stop active: its stop input is open";
    default:
      return "Operation enabled";
  }
}

std::string_view words_of(std::optional<Error> fault, std::uint32_t code) {
  if (!fault || code == 0) return {};
  if (*fault == Error::kSdoAborted) return describe_sdo_abort(code);
  if (*fault == Error::kScaleInvalid) {
    return "this object says that the drive counts otherwise than configured";
  }
  if (!hal::kSmallImage &&
      (*fault == Error::kTransitionTimeout || *fault == Error::kDriveDroppedOut)) {
    return words_of_state(static_cast<std::uint16_t>(code));
  }
  const bool emergency = *fault == Error::kDriveEmergency || *fault == Error::kDriveFault;
  return emergency ? describe_emergency(static_cast<std::uint16_t>(code)) : std::string_view();
}

}  // namespace

hal::DriveStatus DriveNode::status() const {
  hal::DriveStatus status = drive_.status();
  if (!hal::kSmallImage && s_.absent && !status.fault) {
    status.condition = hal::DriveCondition::kFaulted;
    status.fault = Error::kDriveAbsent;
  }
  status.words = words_of(status.fault, status.fault_code);
  status.fault_details = s_.fault_details;
  status.information = s_.information;
  status.information_details = s_.information_details;
  if (!hal::kSmallImage && s_.information != 0) {
    status.information_words = describe_emergency(static_cast<std::uint16_t>(s_.information));
  }
  status.unsupervised = is_started() && s_.unsupervised;
  return status;
}

void DriveNode::enter(Phase phase, hal::Instant now) {
  s_.phase = phase;
  s_.phase_since = now;
  if (phase == Phase::kUnreset) {
    s_.boot_ups = 0;
    s_.wholly_reset = false;
    s_.absent = false;
    drive_.forget();
  }
  if (phase == Phase::kStarted) {
    s_.heard_at = now;
    s_.heard_operational = false;
    s_.missed = 0;
    s_.answered = false;
    s_.sync_unanswered = false;
  }
}

void DriveNode::wait_for_whole_reset(hal::Instant now) {
  s_.wholly_reset = true;
  enter(Phase::kBooting, now);
}

void DriveNode::enter_set_up(const cia402::SetupReport& report, hal::Instant now) {
  s_.unsupervised = !report.is_supervised();
  s_.guarded = report.guarded;
  if (report.hides_mode) drive_.hide_mode();
  enter(cia402::kMostAxes > 1 ? Phase::kConfigured : Phase::kStarted, now);
}

void DriveNode::reset(hal::Instant now) {
  const auto& fault = drive_.state().fault;
  if (s_.phase == Phase::kFailed) {
    enter(Phase::kUnreset, now);
  } else if (fault && needs_setup(*fault)) {
    drive_.leave(*fault == Error::kDriveRebooted);
  }
  drive_.reset(now);
  s_.missed = 0;
  s_.fault_details = {};
}

void DriveNode::reset_with_node(hal::Instant now) {
  if (is_started()) {
    if (!drive_.state().leaving) drive_.leave(false);
  } else if (s_.phase != Phase::kUnreset) {
    enter(Phase::kUnreset, now);
  }
}

void DriveNode::look_again(hal::Instant now) {
  reset(now);
  s_.absent = true;
}

void DriveNode::release(hal::Instant now) {
  if (drive_.has_let_go(now)) enter(Phase::kUnreset, now);
}

bool DriveNode::take_feedback(const hal::ReceivedCanFrame& received) {
  const bool has_torque = drive_.tells_torque();
  if (received.frame.length != kDrivePdoBytes + (has_torque ? kTorqueBytes : 0)) return false;
  if (!is_started()) return true;
  drive_.hear(load<std::uint16_t>(received.frame, 0),
              static_cast<std::int32_t>(load<std::uint32_t>(received.frame, 2)), received.at);
  if (has_torque) {
    const auto per_mille = load<std::uint16_t>(received.frame, kDrivePdoBytes);
    drive_.hear_torque(static_cast<std::int16_t>(per_mille));
  }
  s_.answered = true;
  if (s_.phase == Phase::kStarted) enter(Phase::kRunning, received.at);
  return true;
}

bool DriveNode::take_heartbeat(const hal::CanFrame& frame, hal::Instant now) {
  if (frame.length != 1) return false;
  const auto state = static_cast<NmtState>(frame.data[0] & 0x7FU);
  s_.heard_at = now;
  if (state == NmtState::kBootUp) {
    s_.absent = false;
    const bool late = s_.phase == Phase::kFailed && drive_.state().fault == Error::kDriveAbsent;
    if (is_started()) {
      drive_.latch(Error::kDriveRebooted);
    } else if (late) {
      drive_.reset(now);
      enter(Phase::kBooted, now);
    } else if (s_.phase != Phase::kUnreset && s_.phase != Phase::kFailed) {
      // The boot-up message of the power-up may cross with our reset, whose own then comes in the
      // middle of the set-up: it begins anew.
      if (++s_.boot_ups > kMostBootUps) drive_.latch(Error::kDriveRebooted);
      enter(Phase::kBooted, now);
    }
  } else if (state == NmtState::kOperational) {
    s_.heard_operational = true;
  } else if (s_.phase == Phase::kRunning) {
    // The first TPDO1 overtakes a heartbeat that the drive had queued before it was started.
    const bool overtaken = !s_.heard_operational && state == NmtState::kPreOperational &&
                           drive_.state().goal != cia402::Goal::kEnabled;
    s_.heard_operational = true;
    if (!overtaken) drive_.latch(Error::kDriveNotOperational, frame.data[0]);
  }
  return true;
}

bool DriveNode::take_emergency(const hal::CanFrame& frame) {
  const auto emergency = decode_emergency(frame);
  if (!emergency) return false;
  // "No error" ends nothing, because a fault is forgotten by the operator only. What a device says
  // while it boots may be about the time before.
  if (emergency->code == 0) return true;
  if (!is_started() || is_information(*emergency)) {
    s_.information = emergency->code;
    if constexpr (!hal::kSmallImage) keep_details(*emergency, false);
    return true;
  }
  [[maybe_unused]] const bool explained = drive_.state().fault_code != 0;
  drive_.latch(Error::kDriveEmergency, emergency->code);
  drive_.explain(emergency->code);  // a drive may tell its state before the reason
  if constexpr (!hal::kSmallImage) {
    if (!explained && drive_.state().fault_code == emergency->code) keep_details(*emergency, true);
  }
  return true;
}

void DriveNode::keep_details([[maybe_unused]] const Emergency& emergency,
                             [[maybe_unused]] bool is_fault) {
#ifndef ARMSIG_SMALL_IMAGE
  (is_fault ? s_.fault_details : s_.information_details) = {
      .error_register = emergency.error_register, .own = emergency.own};
#endif
}

void DriveNode::supervise(const Configuration& configuration, bool sync_sent, hal::Instant now) {
  if (!is_started()) return;
  if (!drive_.state().leaving) supervise_link(configuration, sync_sent, now);
  drive_.supervise(configuration, now);
}

void DriveNode::supervise_link(const Configuration& configuration, bool sync_sent,
                               hal::Instant now) {
  if (now - s_.heard_at > configuration.heartbeat_timeout) drive_.latch(Error::kHeartbeatLost);
  if (s_.answered) {
    s_.missed = 0;
  } else if (s_.sync_unanswered) {
    ++s_.missed;
  }
  s_.answered = false;
  s_.sync_unanswered = sync_sent;
  const bool silent = s_.phase == Phase::kStarted
                          ? now - s_.phase_since > configuration.boot_timeout
                          : s_.missed >= configuration.missed_feedback_limit;
  if (silent) drive_.latch(Error::kFeedbackLost);
}

hal::CanFrame DriveNode::command(bool may_release) {
  const cia402::Setpoint setpoint = drive_.command(may_release);
  hal::CanFrame frame{.id = pdo_id(kReceivePdo1Id), .length = kDrivePdoBytes};
  store(frame, 0, setpoint.control_word);
  store(frame, 2, static_cast<std::uint32_t>(setpoint.target_counts));
  return frame;
}

}  // namespace armsig::canopen
