// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_power.hpp"

namespace armsig::simulated {
namespace {

using cia402::State;

// Options 5 to 8 of object 605Ah stay in Quick stop active, 0 to 4 leave it when at rest.
constexpr std::uint16_t kFirstStayingOption = 5;

// Controlword patterns with their masks (CiA 402-2, table of device control commands).
constexpr bool is_shutdown(std::uint16_t word) { return (word & 0x87) == 0x06; }
constexpr bool is_switch_on(std::uint16_t word) { return (word & 0x8F) == 0x07; }
constexpr bool is_enable(std::uint16_t word) { return (word & 0x8F) == 0x0F; }
constexpr bool is_disable_voltage(std::uint16_t word) { return (word & 0x82) == 0x00; }
constexpr bool is_quick_stop(std::uint16_t word) { return (word & 0x86) == 0x02; }

std::uint16_t state_bits(State state) {
  switch (state) {
    case State::kNotReadyToSwitchOn:
      return 0x00;
    case State::kSwitchOnDisabled:
      return 0x40;
    case State::kReadyToSwitchOn:
      return 0x31;
    case State::kSwitchedOn:
      return 0x33;
    case State::kOperationEnabled:
      return 0x37;
    case State::kQuickStopActive:
      return 0x17;
    case State::kFaultReactionActive:
      return 0x1F;
    case State::kFault:
      return 0x08;
  }
  return 0;
}

// Of a state without torque, by a controlword.
State next_of_disabled(State state, std::uint16_t word) {
  using enum State;
  if (state == kSwitchOnDisabled) return is_shutdown(word) ? kReadyToSwitchOn : state;
  if (is_disable_voltage(word) || is_quick_stop(word)) return kSwitchOnDisabled;
  if (state == kReadyToSwitchOn) {
    return is_switch_on(word) || is_enable(word) ? kSwitchedOn : state;
  }
  if (is_enable(word)) return kOperationEnabled;
  return is_shutdown(word) ? kReadyToSwitchOn : state;
}

}  // namespace

std::uint16_t DrivePower::status_word(bool remote, const DriveMotion& motion) const {
  std::uint16_t word = state_bits(state_);
  if (remote) word |= 1U << 9;
  if (state_ == State::kOperationEnabled && after_ramp_ == State::kNotReadyToSwitchOn &&
      motion.follows()) {
    word |= cia402::kStatusFollowsTarget;
  }
  return word;
}

void DrivePower::enter(State state, DriveMotion& motion, bool orderly) {
  state_ = state;
  after_ramp_ = State::kNotReadyToSwitchOn;
  if (state == State::kOperationEnabled) {
    motion.follow();
  } else if (state != State::kQuickStopActive && state != State::kFaultReactionActive) {
    motion.release(orderly);
  }
}

void DrivePower::power_up(DriveMotion& motion) {
  last_word_ = 0;
  enter(State::kSwitchOnDisabled, motion, false);
}

void DrivePower::take_enabled(std::uint16_t word, const StopObjects& objects, DriveMotion& motion) {
  const auto leave_to = [&](State next, std::uint16_t option) {
    if (option == 0) {
      enter(next, motion);
      return;
    }
    after_ramp_ = next;
    motion.stop(objects.deceleration);
  };
  if (is_disable_voltage(word)) {
    enter(State::kSwitchOnDisabled, motion);
  } else if (is_quick_stop(word)) {
    quick_stop(objects, motion);
  } else if (after_ramp_ != State::kNotReadyToSwitchOn) {
    return;
  } else if (is_switch_on(word)) {
    leave_to(State::kSwitchedOn, objects.disable_operation);
  } else if (is_shutdown(word)) {
    leave_to(State::kReadyToSwitchOn, objects.shutdown);
  }
}

bool DrivePower::take(std::uint16_t word, const StopObjects& objects, DriveMotion& motion) {
  const bool reset_edge = (word & 0x80U) != 0 && (last_word_ & 0x80U) == 0;
  last_word_ = word;
  switch (state_) {
    case State::kSwitchOnDisabled:
    case State::kReadyToSwitchOn:
    case State::kSwitchedOn:
      if (const State next = next_of_disabled(state_, word); next != state_) enter(next, motion);
      break;
    case State::kOperationEnabled:
      take_enabled(word, objects, motion);
      break;
    case State::kQuickStopActive:
      if (is_disable_voltage(word)) enter(State::kSwitchOnDisabled, motion);
      if (is_enable(word) && objects.quick_stop >= kFirstStayingOption) {
        enter(State::kOperationEnabled, motion);
      }
      break;
    case State::kFault:
      if (reset_edge) {
        enter(State::kSwitchOnDisabled, motion);
        return true;
      }
      break;
    case State::kNotReadyToSwitchOn:
    case State::kFaultReactionActive:
      break;
  }
  return false;
}

void DrivePower::quick_stop(const StopObjects& objects, DriveMotion& motion) {
  if (objects.quick_stop == 0) {
    enter(State::kSwitchOnDisabled, motion);
    return;
  }
  enter(State::kQuickStopActive, motion);
  const bool slow = objects.quick_stop == 1 || objects.quick_stop == kFirstStayingOption;
  motion.stop(slow ? objects.deceleration : objects.quick_deceleration);
  if (objects.quick_stop < kFirstStayingOption) after_ramp_ = State::kSwitchOnDisabled;
}

void DrivePower::fail(const StopObjects& objects, DriveMotion& motion) {
  if (state_ == State::kFault || state_ == State::kFaultReactionActive) return;
  const bool had_torque = state_ == State::kOperationEnabled || state_ == State::kQuickStopActive;
  if (!had_torque || objects.fault_reaction == 0) {
    enter(State::kFault, motion, false);
    return;
  }
  enter(State::kFaultReactionActive, motion);
  motion.stop(objects.fault_reaction == 1 ? objects.deceleration : objects.quick_deceleration);
}

void DrivePower::remove_power(DriveMotion& motion) {
  if (state_ != State::kFault) enter(State::kSwitchOnDisabled, motion, false);
}

void DrivePower::advance(DriveMotion& motion) {
  if (!motion.at_rest()) return;
  if (state_ == State::kFaultReactionActive) {
    enter(State::kFault, motion);
  } else if (after_ramp_ != State::kNotReadyToSwitchOn) {
    enter(after_ramp_, motion);
  }
}

}  // namespace armsig::simulated
