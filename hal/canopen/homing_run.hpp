// SPDX-License-Identifier: MIT
// One drive from cyclic synchronous positions into homing mode and back (CiA 402-2), by SDO: its
// method (6098h) where one is configured, the mode (6060h), which must be shown (6061h) before the
// search begins; then, once the drive stands, its former mode.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/canopen/configuration.hpp"
#include "hal/canopen/sdo_client.hpp"
#include "hal/cia402/drive.hpp"

namespace armsig::canopen {

class HomingRun {
 public:
  // `configuration` must outlive it.
  HomingRun(const Configuration& configuration, std::size_t joint);

  // Takes a frame with the identifier of this node's SDO responses.
  void take(const hal::CanFrame& frame);
  // Once a tick: what `drive` is told, and the frame to send now, if there is one. Latches
  // kSdoTimeout, kSdoAborted, kSdoUnexpectedValue, kStopTimeout.
  [[nodiscard]] std::optional<hal::CanFrame> poll(cia402::Drive& drive, hal::Instant now);
  [[nodiscard]] std::size_t joint() const { return joint_; }
  // The drive follows targets again, or whether it does is asked when it is enabled next.
  [[nodiscard]] bool is_over() const { return step_ == Step::kOver; }

 private:
  enum class Step : std::uint8_t { kMethod, kEnter, kLook, kSearch, kStand, kLeave, kOver };

  void enter(Step step);
  void ask(const SdoRequest& request);
  void wait_for_standstill(cia402::Drive& drive, hal::Instant now);
  void hear(const SdoOutcome& outcome, cia402::Drive& drive, hal::Instant now);
  void look(std::uint32_t mode, cia402::Drive& drive, hal::Instant now);

  const Configuration& configuration_;
  std::size_t joint_;
  Step step_ = Step::kMethod;
  SdoRequest request_;
  std::optional<SdoTransfer> transfer_;
};

}  // namespace armsig::canopen
