// SPDX-License-Identifier: MIT
// Profile position mode of an emulated drive, device side: CiA 402-2. A target is taken at the
// rising edge of the controlword's bit 4, and gone for at once by a trapezoidal profile.
#pragma once

#include <cstdint>

#include "hal/simulated/drive_motion.hpp"

namespace armsig::simulated {

// In counts of the motor.
struct ProfileObjects {
  double speed = 0;         // 6081h, counts/s
  double acceleration = 0;  // 6083h, counts/s^2
  double deceleration = 0;  // 6084h
};

class DriveProfile {
 public:
  // The drive is enabled in this mode: it holds where it is.
  void begin(const DriveMotion& motion);
  // A controlword, and the target [counts of the motor] that came with it.
  void command(bool offered, double target, const DriveMotion& motion);
  // Once a step of the motion.
  void step(const ProfileObjects& objects, DriveMotion& motion);
  // Bits 10 and 12 of the statusword.
  [[nodiscard]] std::uint16_t status_bits(const DriveMotion& motion) const;

 private:
  double target_ = 0;
  double reference_ = 0;
  double speed_ = 0;  // signed
  bool offered_ = false;
  bool taken_ = false;
};

}  // namespace armsig::simulated
