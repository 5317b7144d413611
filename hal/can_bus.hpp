// SPDX-License-Identifier: MIT
// One classical CAN controller (ISO 11898-1), seen without its registers.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/base/error.hpp"
#include "hal/clock.hpp"

namespace armsig::hal {

inline constexpr std::uint8_t kMaxCanData = 8;

struct CanFrame {
  std::uint32_t id = 0;  // 11 bits, or 29 of an extended frame
  bool extended = false;
  bool remote = false;      // asks for data instead of carrying it
  std::uint8_t length = 0;  // bytes used of `data`
  std::array<std::uint8_t, kMaxCanData> data{};

  friend bool operator==(const CanFrame&, const CanFrame&) = default;
};

struct ReceivedCanFrame {
  CanFrame frame;
  Instant at;  // when the frame ended on the wire, as exactly as the backend knows
};

// The fault confinement states of ISO 11898-1, and an interface that is administratively down.
enum class CanState : std::uint8_t { kActive, kWarning, kPassive, kBusOff, kDown };

struct CanStatus {
  CanState state = CanState::kDown;
  std::uint64_t sent = 0;  // of 32 bits it would wrap within a week
  std::uint64_t received = 0;
  std::uint32_t lost = 0;          // received frames that no queue had room for
  std::uint32_t error_frames = 0;  // protocol errors told by the controller
  std::uint32_t bus_offs = 0;
  std::uint32_t restarts = 0;  // times the backend brought the controller back
};

class CanBus {
 public:
  // Queues `frame`; never blocks. The order of queued frames is kept.
  // Errors: kBusDown, kBusOff, kBusBusy (no room, the frame is not queued).
  Result<void> send(const CanFrame& frame);

  // The oldest frame received and not yet handed out; never blocks. Frames sent through this object
  // are not received. No errors: a bus that is down or off receives nothing, and status() says why.
  [[nodiscard]] std::optional<ReceivedCanFrame> receive() { return do_receive(); }

  // Also takes the backend's steps of recovery from bus-off or an interface that went away, so call
  // it regularly, once a tick; never blocks. No errors.
  [[nodiscard]] CanStatus status() { return do_status(); }

 protected:
  ~CanBus() = default;

 private:
  virtual Result<void> do_send(const CanFrame& frame) = 0;
  virtual std::optional<ReceivedCanFrame> do_receive() = 0;
  virtual CanStatus do_status() = 0;
};

}  // namespace armsig::hal
