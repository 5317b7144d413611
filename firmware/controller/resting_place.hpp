// SPDX-License-Identifier: MIT
// Where the arm rests without torque: kept when the torque goes, and compared at the next power-up.
#pragma once

#include "firmware/controller/announcer.hpp"
#include "firmware/controller/link.hpp"
#include "firmware/controller/position_keeper.hpp"

namespace armsig::controller {

class RestingPlace {
 public:
  // `sector` of the memory is for this alone.
  RestingPlace(const Arm& drawing, hal::NonvolatileMemory& memory, std::size_t sector)
      : drawing_(drawing), keeper_(memory, sector) {}

  // The positions are known for the first time, without torque: the joints that are elsewhere than
  // at the last power-down are told, for the operator to know whether the arm was moved by hand.
  // After that first time it does nothing.
  void compare(const JointVector& now, const Announcer& announcer);

  // To be called in every step of the background; one erase or one page at most.
  void step(const Snapshot& now);

 private:
  const Arm& drawing_;
  PositionKeeper keeper_;
  bool had_torque_ = false;  // and where the arm came to rest is still to be kept
  bool compared_ = false;
};

}  // namespace armsig::controller
