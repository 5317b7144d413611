// SPDX-License-Identifier: MIT
// A CAN bus in virtual time: frames take their bit time, the lowest identifier wins the bus.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/can_bus.hpp"
#include "hal/simulated/can_device.hpp"
#include "hal/simulated/virtual_clock.hpp"

namespace armsig::simulated {

class VirtualCanBus;

// A first-in-first-out queue without a heap.
template <typename T, std::size_t kCapacity>
class Ring {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] bool full() const { return size_ == kCapacity; }
  [[nodiscard]] const T& front() const { return items_[first_]; }
  void push(const T& item) { items_[(first_ + size_++) % kCapacity] = item; }
  void pop() {
    first_ = (first_ + 1) % kCapacity;
    --size_;
  }
  void clear() { size_ = 0; }

 private:
  std::array<T, kCapacity> items_{};
  std::size_t first_ = 0;
  std::size_t size_ = 0;
};

// One controller on the bus: what a device of the bus, or the master, sends and receives with.
class VirtualCanPort final : public hal::CanBus {
 public:
  static constexpr std::size_t kSendQueue = 64;
  static constexpr std::size_t kReceiveQueue = 256;

  // Bus-off and a downed interface, as a test commands them. A bus-off controller comes back by
  // itself after VirtualCanBus::kBusOffRecovery.
  void go_bus_off();
  void set_up(bool up);

 private:
  friend class VirtualCanBus;
  struct Queued {
    hal::CanFrame frame;
    hal::Instant ready;
  };

  Result<void> do_send(const hal::CanFrame& frame) override;
  std::optional<hal::ReceivedCanFrame> do_receive() override;
  hal::CanStatus do_status() override;
  void deliver(const hal::ReceivedCanFrame& received);

  VirtualCanBus* bus_ = nullptr;
  bool up_ = true;
  std::optional<hal::Instant> bus_off_since_;
  Ring<Queued, kSendQueue> send_queue_;
  Ring<hal::ReceivedCanFrame, kReceiveQueue> receive_queue_;
  hal::CanStatus status_;
};

// Watches every frame on the wire, for logs and captures.
class CanWatcher {
 public:
  void see(const hal::ReceivedCanFrame& received) { do_see(received); }

 protected:
  ~CanWatcher() = default;

 private:
  virtual void do_see(const hal::ReceivedCanFrame& received) = 0;
};

class VirtualCanBus final : public TimeDriven {
 public:
  static constexpr std::size_t kMaxPorts = 16;
  // 128 times 11 recessive bits (ISO 11898-1, 12.1.4.4) and the pause of a driver before it tries.
  static constexpr hal::Duration kBusOffRecovery = std::chrono::milliseconds(100);

  explicit VirtualCanBus(std::uint32_t bits_per_second = 1'000'000);

  // Connects a controller; with `device`, its frames go there instead of into a queue, and the
  // device is advanced to the end of every frame on the bus. Both must outlive the bus.
  void connect(VirtualCanPort& port, CanDevice* device = nullptr);
  void set_watcher(CanWatcher* watcher) { watcher_ = watcher; }

  [[nodiscard]] hal::Instant now() const { return now_; }
  // Time the wire was occupied since the start.
  [[nodiscard]] hal::Duration busy() const { return busy_; }

 private:
  friend class VirtualCanPort;
  struct Connection {
    VirtualCanPort* port = nullptr;
    CanDevice* device = nullptr;
  };

  void do_advance(hal::Instant until) override;
  void advance_devices(hal::Instant until);
  [[nodiscard]] VirtualCanPort* winner(hal::Instant at) const;
  [[nodiscard]] std::optional<hal::Instant> earliest_ready() const;

  hal::Duration bit_time_;
  FixedVector<Connection, kMaxPorts> connections_;
  CanWatcher* watcher_ = nullptr;
  hal::Instant now_;
  hal::Instant free_at_;  // when the frame on the wire ends
  hal::Duration busy_{};
};

}  // namespace armsig::simulated
