// SPDX-License-Identifier: MIT
// The power state machine of CiA 402-2, device side, of an emulated drive.
#pragma once

#include <cstdint>

#include "hal/canopen/cia402.hpp"
#include "hal/simulated/drive_motion.hpp"

namespace armsig::simulated {

class DrivePower {
 public:
  [[nodiscard]] canopen::cia402::State state() const { return state_; }
  // Statusword 6041h, the state and its bits; `remote` tells that the network is in command.
  [[nodiscard]] std::uint16_t status_word(bool remote, bool following_error) const;

  // Transition 1, and again after a power-up.
  void power_up(DriveMotion& motion);
  // One controlword; `quick_stop_option` is object 605Ah. True if it acknowledged a fault
  // (transition 15).
  bool take(std::uint16_t control_word, std::uint16_t quick_stop_option, DriveMotion& motion);
  // Transition 13; 14 follows when the motor is at rest.
  void fail(DriveMotion& motion);
  // The power stage is switched off from outside (safe torque off).
  void remove_power(DriveMotion& motion);
  // Quick stop by the drive itself, as object 6007h may ask for when the master is lost.
  void quick_stop(std::uint16_t quick_stop_option, DriveMotion& motion);
  // Transitions that wait for the motor to be at rest: 5 and 8, 12 by option, 14.
  void advance(DriveMotion& motion);

 private:
  using State = canopen::cia402::State;

  void enter(State state, DriveMotion& motion);

  State state_ = State::kNotReadyToSwitchOn;
  State after_ramp_ = State::kNotReadyToSwitchOn;  // kNotReadyToSwitchOn: no ramp is under way
  std::uint16_t last_word_ = 0;
};

}  // namespace armsig::simulated
