// SPDX-License-Identifier: MIT
// The newest value of one thread, for one other, without a lock: neither ever waits.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace armsig::controller {

// Triple buffer: the writer owns one slot, the reader another, and they swap through the third.
template <typename T>
class LatestValue {
 public:
  // Writer's side: fill writing(), then publish() it.
  [[nodiscard]] T& writing() { return slots_[writing_]; }
  void publish() {
    const std::uint8_t taken =
        between_.exchange(static_cast<std::uint8_t>(writing_ | kFresh), std::memory_order_acq_rel);
    writing_ = taken & kSlot;
  }

  // Reader's side: the newest value published, the default one before the first.
  [[nodiscard]] const T& read() {
    if ((between_.load(std::memory_order_relaxed) & kFresh) != 0) {
      reading_ = between_.exchange(reading_, std::memory_order_acq_rel) & kSlot;
    }
    return slots_[reading_];
  }

 private:
  static constexpr std::uint8_t kSlot = 3;
  static constexpr std::uint8_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::atomic<std::uint8_t> between_{1};
  std::uint8_t writing_ = 0;  // the writer's alone
  std::uint8_t reading_ = 2;  // the reader's alone
};

}  // namespace armsig::controller
