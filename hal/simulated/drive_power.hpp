// SPDX-License-Identifier: MIT
// The power state machine of CiA 402-2, device side, of an emulated drive.
#pragma once

#include <cstdint>

#include "hal/cia402/state_machine.hpp"
#include "hal/simulated/drive_motion.hpp"

namespace armsig::simulated {

// How the drive comes to rest, by its objects.
struct StopObjects {
  std::uint16_t quick_stop = 2;         // 605Ah: ramp of 6085h, then disabled
  std::uint16_t shutdown = 1;           // 605Bh: 0 takes the torque off, 1 ramp of 6084h first
  std::uint16_t disable_operation = 1;  // 605Ch: as above
  std::uint16_t fault_reaction = 2;     // 605Eh: as above, 2 ramp of 6085h first
  double deceleration = 0;              // 6084h, counts/s^2
  double quick_deceleration = 0;        // 6085h
};

class DrivePower {
 public:
  [[nodiscard]] cia402::State state() const { return state_; }
  // Statusword 6041h: the state's own bits, remote (the network is in command), bit 12.
  [[nodiscard]] std::uint16_t status_word(bool remote, const DriveMotion& motion) const;

  // Transition 1, and again after a power-up.
  void power_up(DriveMotion& motion);
  // One controlword. True if it acknowledged a fault (transition 15).
  bool take(std::uint16_t control_word, const StopObjects& objects, DriveMotion& motion);
  // Transition 13; 14 follows when the motor is at rest.
  void fail(const StopObjects& objects, DriveMotion& motion);
  // The power stage is switched off from outside (safe torque off).
  void remove_power(DriveMotion& motion);
  // Quick stop, commanded or by the drive itself, as object 6007h may ask for when the master is
  // lost.
  void quick_stop(const StopObjects& objects, DriveMotion& motion);
  // Transitions that wait for the motor to be at rest: 5 and 8, 12 by option, 14.
  void advance(DriveMotion& motion);

 private:
  using State = cia402::State;

  void enter(State state, DriveMotion& motion, bool orderly = true);
  void take_enabled(std::uint16_t word, const StopObjects& objects, DriveMotion& motion);

  State state_ = State::kNotReadyToSwitchOn;
  State after_ramp_ = State::kNotReadyToSwitchOn;  // kNotReadyToSwitchOn: no ramp is under way
  std::uint16_t last_word_ = 0;
};

}  // namespace armsig::simulated
