// SPDX-License-Identifier: MIT
// A CAN interface of Linux, by a raw socket (Documentation/networking/can.rst of the kernel).
#pragma once

#include <sys/socket.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/fixed_vector.hpp"
#include "hal/can_bus.hpp"
#include "hal/linux/back_off.hpp"
#include "hal/linux/file_descriptor.hpp"

namespace armsig::linux_hal {

inline constexpr std::size_t kMaxCanFilters = 16;

// How many frames the interface's own queue holds (`ip link set NAME txqueuelen N`); 0: it has none
// and sends at once; empty: there is no such interface.
[[nodiscard]] std::optional<unsigned> send_queue_frames(const std::string& interface_name);

// Frames with (identifier & mask) == (this identifier & mask) are received.
struct CanFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
};

struct SocketCanConfiguration {
  std::string interface_name;  // at most 15 characters
  // Of data frames with 11-bit identifiers; none: all of them. Extended and remote frames, which no
  // CANopen device of ours sends, are left to the kernel.
  FixedVector<CanFilter, kMaxCanFilters> filters;
  // Another thread calls maintain(): status() then waits for no lock of the network's settings.
  bool maintained = false;
};

// The interface need not exist yet: it is opened as soon as it does, reopened when it was gone,
// used again when it was down, and its controller restarted when it was bus-off, each with a
// back-off. All that happens inside status(), but for the restart, which waits for whoever changes
// the network's settings at that moment: a thread without deadlines does it by maintain(). Stamps
// are the kernel's, told in CLOCK_MONOTONIC; where the wall clock is set, those of one tick are
// wrong by as much.
class SocketCan final : public hal::CanBus {
 public:
  explicit SocketCan(const SocketCanConfiguration& configuration);

  // What status() has asked for; from another thread, at least once a second. Only where
  // SocketCanConfiguration::maintained.
  void maintain();

  // The errno value of the last try to open the interface or to restart its controller, 0 after a
  // success; for the log.
  [[nodiscard]] int last_errno() const { return last_errno_; }

  // As of the last status(), without its steps of recovery; for the log.
  [[nodiscard]] hal::CanStatus last_status() const;

 private:
  Result<void> do_send(const hal::CanFrame& frame) override;
  std::optional<hal::ReceivedCanFrame> do_receive() override;
  hal::CanStatus do_status() override;

  [[nodiscard]] int open_socket();
  void close_socket(int reason);
  [[nodiscard]] bool interface_is_up();
  // What the kernel says beside a frame: when it came, which is returned, and how many it lost.
  hal::Instant take_control(msghdr& message);
  void take_error_frame(std::uint32_t error_class, std::uint8_t controller_status);
  void leave_bus_off();
  void take_restart();

  SocketCanConfiguration configuration_;
  FileDescriptor socket_;
  unsigned interface_index_ = 0;
  bool up_ = false;
  hal::CanState controller_ = hal::CanState::kActive;
  BackOff reopen_;
  BackOff restart_;
  hal::Instant restarted_at_;
  std::uint32_t kernel_drops_ = 0;  // as the socket counts them since it was opened
  int last_errno_ = 0;
  // Between status() and maintain(): the interface to be restarted, 0: none; and what came of it.
  static constexpr int kNoResult = -1;
  std::atomic<unsigned> restart_asked_{0};
  std::atomic<int> restart_result_{kNoResult};
  // As of the last status(): the time, and how far CLOCK_REALTIME, in which the kernel stamps
  // frames, is ahead of CLOCK_MONOTONIC. Read there and not for each frame, to save system calls.
  hal::Instant now_;
  hal::Duration wall_ahead_{};
  hal::CanStatus counts_;
};

}  // namespace armsig::linux_hal
