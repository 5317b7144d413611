// SPDX-License-Identifier: MIT
// What a simulated device on a CAN bus is to the bus, whether that is virtual or real.
#pragma once

#include "hal/can_bus.hpp"
#include "hal/simulated/virtual_clock.hpp"

namespace armsig::simulated {

// A device that sends through the CanBus it was made with. Whoever runs it advances it often, and
// gives it every frame of others, first advancing it to the frame's time.
class CanDevice : public TimeDriven {
 public:
  void take(const hal::ReceivedCanFrame& received) { do_take(received); }

 protected:
  ~CanDevice() = default;

 private:
  virtual void do_take(const hal::ReceivedCanFrame& received) = 0;
};

}  // namespace armsig::simulated
