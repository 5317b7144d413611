// SPDX-License-Identifier: MIT
#include "hal/simulated/virtual_can_bus.hpp"

#include <algorithm>

#include "core/base/check.hpp"
#include "hal/simulated/can_bits.hpp"

namespace armsig::simulated {

void VirtualCanPort::go_bus_off() {
  ARMSIG_CHECK(bus_ != nullptr);
  bus_off_since_ = bus_->now();
  send_queue_.clear();
  ++status_.bus_offs;
}

void VirtualCanPort::set_up(bool up) {
  up_ = up;
  if (!up) send_queue_.clear();
}

Result<void> VirtualCanPort::do_send(const hal::CanFrame& frame) {
  ARMSIG_CHECK(bus_ != nullptr);
  if (!up_) return std::unexpected(Error::kBusDown);
  if (bus_off_since_) return std::unexpected(Error::kBusOff);
  if (send_queue_.full()) return std::unexpected(Error::kBusBusy);
  send_queue_.push({frame, bus_->now()});
  return {};
}

std::optional<hal::ReceivedCanFrame> VirtualCanPort::do_receive() {
  if (receive_queue_.empty()) return std::nullopt;
  const hal::ReceivedCanFrame received = receive_queue_.front();
  receive_queue_.pop();
  return received;
}

hal::CanStatus VirtualCanPort::do_status() {
  if (bus_off_since_ && bus_->now() - *bus_off_since_ >= VirtualCanBus::kBusOffRecovery) {
    bus_off_since_.reset();
    ++status_.restarts;
  }
  if (!up_) {
    status_.state = hal::CanState::kDown;
  } else {
    status_.state = bus_off_since_ ? hal::CanState::kBusOff : hal::CanState::kActive;
  }
  return status_;
}

void VirtualCanPort::deliver(const hal::ReceivedCanFrame& received) {
  if (receive_queue_.full()) {
    ++status_.lost;
    return;
  }
  ++status_.received;
  receive_queue_.push(received);
}

VirtualCanBus::VirtualCanBus(std::uint32_t bits_per_second)
    : bit_time_(std::chrono::nanoseconds(1'000'000'000 / bits_per_second)) {}

void VirtualCanBus::connect(VirtualCanPort& port, CanDevice* device) {
  port.bus_ = this;
  connections_.push_back({&port, device});
}

std::optional<hal::Instant> VirtualCanBus::earliest_ready() const {
  std::optional<hal::Instant> earliest;
  for (const Connection& connection : connections_) {
    const auto& queue = connection.port->send_queue_;
    if (queue.empty()) continue;
    if (!earliest || queue.front().ready < *earliest) earliest = queue.front().ready;
  }
  return earliest;
}

// Arbitration (ISO 11898-1, 10.3) of those who want to send.
VirtualCanPort* VirtualCanBus::winner(hal::Instant at) const {
  VirtualCanPort* winner = nullptr;
  for (const Connection& connection : connections_) {
    const auto& queue = connection.port->send_queue_;
    if (queue.empty() || queue.front().ready > at) continue;
    if (winner == nullptr ||
        precedence(queue.front().frame) < precedence(winner->send_queue_.front().frame)) {
      winner = connection.port;
    }
  }
  return winner;
}

void VirtualCanBus::advance_devices(hal::Instant until) {
  now_ = until;
  for (const Connection& connection : connections_) {
    if (connection.device != nullptr) connection.device->advance(until);
  }
}

void VirtualCanBus::do_advance(hal::Instant until) {
  while (const auto ready = earliest_ready()) {
    const hal::Instant start = std::max(free_at_, *ready);
    if (start >= until) break;
    VirtualCanPort* sender = winner(start);
    const hal::CanFrame frame = sender->send_queue_.front().frame;
    const hal::Duration length = bit_time_ * wire_bits(frame);
    // A frame that ends after `until` is left to the next call; nobody can have seen it begin.
    if (start + length > until) break;
    sender->send_queue_.pop();
    free_at_ = start + length;
    busy_ += length;
    ++sender->status_.sent;
    advance_devices(free_at_);
    const hal::ReceivedCanFrame received{frame, free_at_};
    if (watcher_ != nullptr) watcher_->see(received);
    for (const Connection& connection : connections_) {
      VirtualCanPort& port = *connection.port;
      if (&port == sender || !port.up_ || port.bus_off_since_) continue;
      if (connection.device != nullptr) {
        connection.device->take(received);
      } else {
        port.deliver(received);
      }
    }
  }
  advance_devices(until);
}

}  // namespace armsig::simulated
