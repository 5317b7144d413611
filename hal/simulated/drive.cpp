// SPDX-License-Identifier: MIT
#include "hal/simulated/drive.hpp"

#include <cmath>

namespace armsig::simulated {
namespace {

using canopen::kPdoOff;
using canopen::NmtCommand;
using canopen::NmtState;
using cia402::State;

constexpr std::uint16_t kModeBit = 0x0010;  // bit 4 of the controlword, whose meaning is the mode's
constexpr std::uint8_t kProfileMode = 1;
constexpr std::uint8_t kHomingMode = 6;
constexpr std::uint8_t kInterpolatedMode = 7;
constexpr std::uint32_t kNodes = 128;  // beyond any node number
constexpr std::uint16_t kEmergencyHeartbeat = 0x8130;
constexpr std::uint16_t kEmergencyPdoLength = 0x8210;
constexpr std::uint16_t kEmergencyCommands = 0x8250;
constexpr std::uint16_t kEmergencyFollowing = 0x8611;
constexpr std::uint16_t kEmergencySync = 0x8700;

}  // namespace

DriveConfiguration honest_drive(std::uint8_t node, double counts_per_radian) {
  return {.node = node,
          .motion = honest_motion(counts_per_radian),
          .tells_rest = true,
          .answer_delay = std::chrono::microseconds(200),
          .answer_jitter = std::chrono::microseconds(200)};
}

DriveConfiguration honest_slide_drive(std::uint8_t node, double counts_per_metre) {
  DriveConfiguration drive = honest_drive(node, counts_per_metre);
  drive.motion = honest_slide(counts_per_metre);
  return drive;
}

void let_home(DriveConfiguration& drive, double speed) {
  drive.counts_anew = true;
  drive.home_switch = 0;
  drive.home_speed = speed;
}

Drive::Drive(const DriveConfiguration& configuration, hal::CanBus& bus, hal::Instant now)
    : configuration_(configuration),
      bus_(&bus),
      dictionary_(configuration.node, configuration.serial, configuration.encoder_counts,
                  configuration.edits, configuration.axis),
      motion_(configuration.motion, now),
      now_(now),
      boot_at_(now + configuration.boot_time),
      jitter_(configuration.node + kNodes * (configuration.axis.number - 1U)) {
  if (configuration.counts_anew) origin_ = motion_.state().position;
  restore_dictionary();
  publish();
}

void Drive::send(const hal::CanFrame& frame) {
  // A full queue loses the frame, as it does in a real device.
  if (fault_ != DriveFault::kSilent) (void)bus_->send(frame);
}

void Drive::send_emergency(std::uint16_t code) {
  // Error register 1001h: generic, communication (bit 4) or profile specific (bit 5).
  std::uint8_t error_register = 0;
  if (code != 0) {
    const std::uint16_t group = code & 0xFF00U;
    const bool of_bus = group == 0x8100 || group == 0x8200;
    if (of_bus && !speaks_for_node()) return;  // the first axis tells it
    error_register = of_bus ? 0x11 : 0x21;
  }
  send_emergency(code, error_register);
}

void Drive::send_emergency(std::uint16_t code, std::uint8_t error_register) {
  dictionary_.set(0x1001, 0, error_register);
  dictionary_.set(0x603F, 0, code);
  hal::CanFrame frame{.id = canopen::kEmergencyId + configuration_.node, .length = 8};
  canopen::store(frame, 0, code);
  frame.data[2] = error_register;
  if (nmt_ == NmtState::kOperational || nmt_ == NmtState::kPreOperational) send(frame);
}

void Drive::fail(std::uint16_t code) {
  send_emergency(code);
  power_.fail(settings_.stops, motion_);
  publish();
}

void Drive::reset(bool whole_device) {
  nmt_ = NmtState::kBootUp;
  boot_at_ = now_ + configuration_.boot_time;
  restore_dictionary();
  homing_.forget();
  if (whole_device && configuration_.counts_anew) origin_ = motion_.state().position;
  pending_pdo_.reset();
  answer_at_.reset();
  master_heard_.reset();
  commanded_at_.reset();
  guarded_at_.reset();
  guard_toggle_ = false;
  sync_at_.reset();
  tells_boot_up_ = whole_device || !configuration_.boots_quietly;
  // Without settings nobody can command the motor, so the torque goes; but a fault outlives a reset
  // of the communication.
  if (whole_device || power_.state() != State::kFault) power_.power_up(motion_);
  publish();
}

void Drive::enter(NmtState state) {
  if (state == nmt_) return;
  nmt_ = state;
  sync_at_.reset();
  commanded_at_.reset();
  next_heartbeat_ = now_;
  // Without PDOs nobody commands the drive (abort connection, object 6007h).
  if (state != NmtState::kOperational && power_.state() == State::kOperationEnabled) {
    power_.quick_stop(settings_.stops, motion_);
  }
}

void Drive::inject(DriveFault fault, std::int32_t code) {
  motion_.set_blocked(fault == DriveFault::kBlocked);
  motion_.set_ignores(fault == DriveFault::kIgnoresTargets);
  jump_ = fault == DriveFault::kPositionJump ? code : 0;
  bits_ = static_cast<std::uint16_t>(code);
  fault_ = fault;
  if (fault == DriveFault::kEmergency) fail(static_cast<std::uint16_t>(code));
  if (fault == DriveFault::kPowerRemoved) power_.remove_power(motion_);
  if (fault == DriveFault::kReboot) reset(true);
  if (fault == DriveFault::kInformation) send_emergency(bits_, 0);
  if (fault == DriveFault::kPreOperational) enter(NmtState::kPreOperational);
}

void Drive::do_advance(hal::Instant until) {
  now_ = until;
  if (answer_at_ && until >= *answer_at_) answer_sync();
  // Between two steps of the motion nothing of the drive's own changes.
  bool stepped = false;
  for (; motion_.step_before(until); stepped = true) {
    power_.advance(motion_);
    step_homing();
    step_profile();
  }
  if (!stepped) return;
  if (nmt_ == NmtState::kBootUp) {
    if (until < boot_at_) return;
    if (power_.state() == State::kNotReadyToSwitchOn) power_.power_up(motion_);
    nmt_ = NmtState::kPreOperational;
    next_heartbeat_ = until;
    if (tells_boot_up_ && speaks_for_node())
      send(canopen::heartbeat_frame(configuration_.node, NmtState::kBootUp));
  }
  if (settings_.heartbeat > hal::Duration::zero() && until >= next_heartbeat_) {
    next_heartbeat_ = until + settings_.heartbeat;
    if (fault_ != DriveFault::kHeartbeatLost && speaks_for_node()) {
      send(canopen::heartbeat_frame(configuration_.node, nmt_));
    }
  }
  supervise();
}

// By option of object 6007h.
void Drive::miss_master(std::uint16_t code) {
  constexpr std::uint32_t kNothing = 0;
  constexpr std::uint32_t kQuickStop = 3;
  const std::uint32_t option = dictionary_.get(0x6007);
  const bool enabled = power_.state() == State::kOperationEnabled;
  if (enabled && option != kNothing && option != kQuickStop) {
    fail(code);
    return;
  }
  send_emergency(code);
  if (enabled && option == kQuickStop) power_.quick_stop(settings_.stops, motion_);
}

void Drive::supervise() {
  if (master_heard_ && now_ - *master_heard_ > settings_.master_timeout) {
    master_heard_.reset();
    miss_master(kEmergencyHeartbeat);
  }
  const bool is_guarded = settings_.life_time > hal::Duration::zero();
  if (is_guarded && guarded_at_ && now_ - *guarded_at_ > settings_.life_time) {
    guarded_at_.reset();
    miss_master(kEmergencyHeartbeat);
  }
  const bool watches_commands = settings_.command_timeout > hal::Duration::zero();
  if (watches_commands && commanded_at_ && now_ - *commanded_at_ > settings_.command_timeout) {
    commanded_at_.reset();
    miss_master(kEmergencyCommands);
  }
  const bool watched = configuration_.sync_loss_periods > 0 && sync_at_ &&
                       power_.state() == State::kOperationEnabled;
  if (watched && now_ - *sync_at_ > settings_.period * configuration_.sync_loss_periods) {
    fail(kEmergencySync);
  }
  supervise_following();
}

void Drive::supervise_following() {
  constexpr std::uint32_t kOff = 0xFFFFFFFF;
  const bool beyond = settings_.following_window != kOff &&
                      power_.state() == State::kOperationEnabled &&
                      std::fabs(motion_.following_error()) > settings_.following_window;
  if (!beyond) {
    error_since_.reset();
  } else if (!error_since_) {
    error_since_ = now_;
  } else if (now_ - *error_since_ > settings_.following_timeout) {
    fail(kEmergencyFollowing);
  }
}

void Drive::publish() {
  const auto counts = static_cast<std::int32_t>(std::lround(motion_.counts() - origin_)) + jump_;
  dictionary_.set(0x6064, 0, static_cast<std::uint32_t>(counts));
  dictionary_.set(0x6041, 0, status_word());
  const auto torque = static_cast<std::int16_t>(std::lround(1000 * motion_.torque()));
  dictionary_.set(0x6077, 0, static_cast<std::uint16_t>(torque));
  if (configuration_.shows_mode_late) {
    const bool enabled = power_.state() == State::kOperationEnabled;
    dictionary_.set(0x6061, 0, enabled ? dictionary_.get(0x6060) : 0);
  }
}

std::uint16_t Drive::status_word() const {
  std::uint16_t word = power_.status_word(operational(), motion_);
  const auto without_bit_12 = static_cast<std::uint16_t>(word & ~cia402::kStatusFollowsTarget);
  if (is_in(kHomingMode)) word = without_bit_12 | homing_.status_bits(motion_);
  if (is_in(kProfileMode)) word = without_bit_12 | profile_.status_bits(motion_);
  if (is_in(kInterpolatedMode) && !interpolates()) word = without_bit_12;
  if (error_since_) word |= cia402::kStatusFollowingError;
  if (configuration_.tells_rest && power_.state() == State::kQuickStopActive && motion_.at_rest()) {
    word |= cia402::kStatusTargetReached;
  }
  if (fault_ == DriveFault::kBitsSet) word |= bits_;
  if (fault_ == DriveFault::kBitsClear) word = static_cast<std::uint16_t>(word & ~bits_);
  return word;
}

void Drive::do_take(const hal::ReceivedCanFrame& received) {
  const hal::CanFrame& frame = received.frame;
  const bool hears = fault_ != DriveFault::kSilent && nmt_ != NmtState::kBootUp;
  if (hears && frame.remote && frame.id == canopen::kHeartbeatId + configuration_.node) {
    take_guarding();
  }
  if (frame.extended || frame.remote || !hears) return;
  const std::uint32_t function = frame.id & canopen::kFunctionMask;
  const auto node = static_cast<std::uint8_t>(frame.id & canopen::kNodeMask);
  if (frame.id == canopen::kNmtId) {
    take_nmt(frame);
  } else if (frame.id == canopen::kSyncId) {
    if (fault_ != DriveFault::kSyncLost) take_sync();
  } else if (frame.id == (settings_.receive_pdo & (kPdoOff | 0x7FFU))) {
    take_receive_pdo(frame);
  } else if (function == canopen::kHeartbeatId) {
    take_masters_heartbeat(node);
  } else if (function == canopen::kSdoRequestId && node == configuration_.node &&
             nmt_ != NmtState::kStopped && fault_ != DriveFault::kSdoSilent) {
    publish();
    if (const auto answer = dictionary_.serve(frame)) send(*answer);
    read_settings();
  }
}

// Node guarding: the state, and a bit that alternates. Not beside a heartbeat.
void Drive::take_guarding() {
  if (settings_.heartbeat > hal::Duration::zero()) return;
  guarded_at_ = now_;
  hal::CanFrame answer = canopen::heartbeat_frame(configuration_.node, nmt_);
  if (guard_toggle_) answer.data[0] |= 0x80U;
  guard_toggle_ = !guard_toggle_;
  if (fault_ != DriveFault::kHeartbeatLost && speaks_for_node()) send(answer);
}

void Drive::take_nmt(const hal::CanFrame& frame) {
  if (frame.length != 2 || (frame.data[1] != 0 && frame.data[1] != configuration_.node)) return;
  switch (static_cast<NmtCommand>(frame.data[0])) {
    case NmtCommand::kStart:
      enter(NmtState::kOperational);
      break;
    case NmtCommand::kStop:
      enter(NmtState::kStopped);
      break;
    case NmtCommand::kEnterPreOperational:
      enter(NmtState::kPreOperational);
      break;
    case NmtCommand::kResetNode:
      reset(true);
      break;
    case NmtCommand::kResetCommunication:
      reset(false);
      break;
  }
}

void Drive::take_sync() {
  if (!operational()) return;
  sync_at_ = now_;
  if (pending_pdo_) apply_receive_pdo();
  publish();
  if (configuration_.answer_delay > hal::Duration::zero()) {
    // A linear congruential generator (Numerical Recipes): its high bits are random enough for
    // this.
    jitter_ = 1664525U * jitter_ + 1013904223U;
    answer_at_ =
        now_ + configuration_.answer_delay + configuration_.answer_jitter * (jitter_ >> 16) / 65536;
  } else {
    answer_sync();
  }
}

// With what was true at the SYNC.
void Drive::answer_sync() {
  answer_at_.reset();
  const bool on = (settings_.transmit_pdo & kPdoOff) == 0 && settings_.transmits_on_sync;
  if (on && fault_ != DriveFault::kFeedbackLost) {
    send(dictionary_.pack(0x1A00, settings_.transmit_pdo));
  }
}

void Drive::take_receive_pdo(const hal::CanFrame& frame) {
  if (!operational() || fault_ == DriveFault::kDeaf) return;
  if (frame.length < dictionary_.pdo_bytes(0x1600)) {
    send_emergency(kEmergencyPdoLength);
    return;
  }
  pending_pdo_ = frame;
  commanded_at_ = now_;
  if (!settings_.receives_on_sync) apply_receive_pdo();
}

void Drive::apply_receive_pdo() {
  dictionary_.unpack(0x1600, *pending_pdo_);
  pending_pdo_.reset();
  const auto word = static_cast<std::uint16_t>(dictionary_.get(0x6040));
  if (power_.take(word, settings_.stops, motion_)) send_emergency(0);
  if (power_.state() != State::kOperationEnabled) {
    profile_.begin(motion_);
    return;
  }
  const bool bit_4 = (word & kModeBit) != 0;
  const auto target_of = [&](std::uint16_t index, std::uint8_t subindex) {
    return static_cast<std::int32_t>(dictionary_.get(index, subindex)) + origin_;
  };
  if (settings_.mode == kHomingMode) {
    homing_.command(bit_4, settings_.homing, motion_);
    profile_.begin(motion_);
  } else if (settings_.mode == kProfileMode) {
    profile_.command(bit_4, target_of(0x607A, 0), motion_);
  } else if (settings_.mode == kInterpolatedMode) {
    if (bit_4) follow(target_of(0x60C1, 1));
  } else {
    follow(target_of(0x607A, 0) + settings_.offset);
  }
}

void Drive::follow(double target) {
  motion_.set_target(static_cast<std::int32_t>(std::lround(target)), settings_.period, now_);
}

bool Drive::interpolates() const { return (dictionary_.get(0x6040) & kModeBit) != 0; }

void Drive::step_profile() {
  if (is_in(kProfileMode)) profile_.step(settings_.profile, motion_);
}

void Drive::step_homing() {
  if (!is_in(kHomingMode)) return;
  const auto found = homing_.step(settings_.homing, configuration_.home_switch, motion_);
  if (found) origin_ = *found - settings_.homing.offset;
}

void Drive::take_masters_heartbeat(std::uint8_t node) {
  if (settings_.master_timeout > hal::Duration::zero() && settings_.master == node) {
    master_heard_ = now_;
  }
}

}  // namespace armsig::simulated
