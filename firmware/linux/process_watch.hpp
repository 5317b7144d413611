// SPDX-License-Identifier: MIT
// Whether the process keeps what it promised for after its start-up: nothing from the heap, no page
// faults.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/controller/text.hpp"
#include "hal/linux/real_time.hpp"

namespace armsig::daemon {

class ProcessWatch {
 public:
  // By the servo thread when everything is started; `report` is what it was granted.
  void begin(const linux_hal::RealTimeReport& report, int priority);
  // By the servo thread, now and then.
  void look();

  // By any thread: ` memory_locked=yes real_time=yes heap_calls=0 page_faults=0
  // servo_page_faults=0`.
  void tell(controller::Line& line) const;

 private:
  std::atomic<bool> memory_locked_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<std::uint64_t> heap_calls_before_{0};
  std::atomic<std::int64_t> faults_before_{0};
  std::atomic<std::int64_t> servo_faults_before_{0};
  std::atomic<std::int64_t> servo_faults_{0};
};

}  // namespace armsig::daemon
