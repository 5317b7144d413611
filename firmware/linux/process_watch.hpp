// SPDX-License-Identifier: MIT
// Whether the process keeps what it promised for after its start-up: nothing from the heap, no page
// faults.
#pragma once

#include <atomic>
#include <cstdint>

#include "firmware/controller/text.hpp"
#include "hal/canopen/master.hpp"
#include "hal/linux/real_time.hpp"
#include "hal/linux/socket_can.hpp"

namespace armsig::daemon {

class ProcessWatch {
 public:
  // By the servo thread when everything is started; `report` is what it was granted.
  void begin(const linux_hal::RealTimeReport& report, int priority);
  // By the servo thread, now and then; `bus` and the `master` on it where there is a real one.
  void look(const linux_hal::SocketCan* bus, const canopen::Master* master);
  // What look() has of a bus and its master. `refusal` is the system's last one, an errno; 0: none.
  void look_at(const hal::CanStatus& status, int refusal);
  void look_at(const canopen::MasterCounters& counters);
  // By the servo thread after each tick, and by the background's after each of its turns.
  void ticked() { ++ticks_; }
  void stepped() { ++steps_; }
  // By one thread: whether both have gone on since the last time that they both had.
  [[nodiscard]] bool progressed();

  // By any thread: ` memory_locked=yes real_time=yes heap_calls=0 page_faults=0
  // servo_page_faults=0`, and of a real bus ` can=active can_error_frames=0 can_lost=0
  // can_bus_offs=0 can_restarts=0`, with ` can_says="words"` of the system's last refusal; and of
  // its frames ` can_malformed=0 can_foreign=0 can_unknown=0 can_unsent=0 can_unanswered=0
  // can_late_heartbeats=0 can_emergencies=0 can_repeated=0`.
  void tell(controller::Line& line) const;

 private:
  std::atomic<bool> memory_locked_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<std::uint64_t> heap_calls_before_{0};
  std::atomic<std::int64_t> faults_before_{0};
  std::atomic<std::int64_t> servo_faults_before_{0};
  std::atomic<std::int64_t> servo_faults_{0};
  std::atomic<bool> has_bus_{false};
  std::atomic<hal::CanState> can_state_{hal::CanState::kDown};
  std::atomic<std::uint32_t> can_error_frames_{0};
  std::atomic<std::uint32_t> can_lost_{0};
  std::atomic<std::uint32_t> can_bus_offs_{0};
  std::atomic<std::uint32_t> can_restarts_{0};
  std::atomic<int> can_errno_{0};
  std::atomic<std::uint32_t> can_malformed_{0};
  std::atomic<std::uint32_t> can_foreign_{0};
  std::atomic<std::uint32_t> can_unknown_{0};
  std::atomic<std::uint32_t> can_unsent_{0};
  std::atomic<std::uint32_t> can_unanswered_{0};
  std::atomic<std::uint32_t> can_late_heartbeats_{0};
  std::atomic<std::uint32_t> can_emergencies_{0};
  std::atomic<std::uint32_t> can_repeated_{0};
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<std::uint64_t> steps_{0};
  std::uint64_t seen_ticks_ = 0;
  std::uint64_t seen_steps_ = 0;
};

}  // namespace armsig::daemon
