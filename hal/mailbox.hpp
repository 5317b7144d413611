// SPDX-License-Identifier: MIT
// Hands values from one thread to one other without a lock: neither ever waits.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <optional>

namespace armsig::hal {

// Single producer, single consumer, first in first out. T must be cheap to copy.
template <typename T, std::size_t kCapacity>
class Mailbox {
 public:
  // Producer's side. False if the box is full; the value is then not taken.
  bool post(const T& value) {
    const std::size_t end = end_.load(std::memory_order_relaxed);
    if (end - first_.load(std::memory_order_acquire) == kCapacity) return false;
    slots_[end % kCapacity] = value;
    end_.store(end + 1, std::memory_order_release);
    return true;
  }

  // Consumer's side. The oldest value, if there is one.
  [[nodiscard]] std::optional<T> take() {
    const std::size_t first = first_.load(std::memory_order_relaxed);
    if (first == end_.load(std::memory_order_acquire)) return std::nullopt;
    std::optional<T> value = slots_[first % kCapacity];
    first_.store(first + 1, std::memory_order_release);
    return value;
  }

 private:
  // Counted without end; the difference of two unsigned counters survives their wrapping as long as
  // the capacity divides their range.
  static_assert((kCapacity & (kCapacity - 1)) == 0, "a power of two");

  std::array<T, kCapacity> slots_{};
  std::atomic<std::size_t> first_{0};
  std::atomic<std::size_t> end_{0};
};

}  // namespace armsig::hal
