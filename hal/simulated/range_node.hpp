// SPDX-License-Identifier: MIT
// The CAN side of an emulated range sensor; what it measures is given to it.
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/canopen/protocol.hpp"
#include "hal/range_sensor.hpp"
#include "hal/simulated/can_device.hpp"

namespace armsig::simulated {

class RangeNode final : public CanDevice {
 public:
  // Powered up at `now`; heartbeats every `heartbeat`. `bus` must outlive the node.
  RangeNode(std::uint8_t node, hal::CanBus& bus, hal::Instant now = {},
            hal::Duration heartbeat = std::chrono::milliseconds(50));

  // Sends `reading` as TPDO1 (with its CRC) to TPDO4 if the node is operational; its time stamp is
  // not sent. Two flight times a frame, at most six in all; flight times saturate at 2^32 - 1 ns.
  void publish(const hal::RangeReading& reading);

  [[nodiscard]] canopen::NmtState nmt_state() const { return nmt_; }
  void set_silent(bool silent) { silent_ = silent; }

 private:
  void do_advance(hal::Instant until) override;
  void do_take(const hal::ReceivedCanFrame& received) override;
  void send(const hal::CanFrame& frame);

  std::uint8_t node_;
  hal::CanBus* bus_;
  hal::Duration heartbeat_;
  hal::Instant next_heartbeat_;
  canopen::NmtState nmt_ = canopen::NmtState::kBootUp;
  bool silent_ = false;
};

}  // namespace armsig::simulated
