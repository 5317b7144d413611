// SPDX-License-Identifier: MIT
// Whether the process keeps what it promised for after its start-up: nothing from the heap, no page
// faults.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string_view>

#include "firmware/controller/text.hpp"
#include "hal/canopen/master.hpp"
#include "hal/linux/real_time.hpp"
#include "hal/linux/socket_can.hpp"

namespace armsig::daemon {

// Of one bus: the state of its interface, and counts since it was opened.
struct BusWatch {
  std::atomic<bool> is_real{false};
  std::atomic<hal::CanState> state{hal::CanState::kDown};
  std::atomic<std::uint32_t> error_frames{0};
  std::atomic<std::uint32_t> lost{0};
  std::atomic<std::uint32_t> bus_offs{0};
  std::atomic<std::uint32_t> restarts{0};
  std::atomic<int> last_errno{0};
  std::atomic<std::uint32_t> malformed{0};
  std::atomic<std::uint32_t> foreign{0};
  std::atomic<std::uint32_t> unknown{0};
  std::atomic<std::uint32_t> unsent{0};
  std::atomic<std::uint32_t> unanswered{0};
  std::atomic<std::uint32_t> late_heartbeats{0};
  std::atomic<std::uint32_t> emergencies{0};
  std::atomic<std::uint32_t> repeated{0};

  void look(const hal::CanStatus& status, int refusal);
  void look(const canopen::MasterCounters& counters);
  // ` can=active can_error_frames=0 ...`, with `number` behind each `can`.
  void tell(controller::Line& line, std::string_view number) const;
};

class ProcessWatch {
 public:
  // By the servo thread when everything is started; `report` is what it was granted.
  void begin(const linux_hal::RealTimeReport& report, int priority);
  // By the servo thread, now and then; `buses` and the `master` on them where there are real ones.
  void look(std::span<linux_hal::SocketCan* const> buses, const canopen::Master* master);
  // What look() has of a bus and its master. `refusal` is the system's last one, an errno; 0: none.
  void look_at(std::size_t bus, const hal::CanStatus& status, int refusal) {
    buses_[bus].look(status, refusal);
  }
  void look_at(std::size_t bus, const canopen::MasterCounters& counters) {
    buses_[bus].look(counters);
  }
  // By the servo thread after each tick, and by the background's after each of its turns.
  void ticked() { ++ticks_; }
  void stepped() { ++steps_; }
  // By one thread: whether both have gone on since the last time that they both had.
  [[nodiscard]] bool progressed();

  // By any thread: ` memory_locked=yes real_time=yes heap_calls=0 page_faults=0
  // servo_page_faults=0`, and of a real bus ` can=active can_error_frames=0 can_lost=0
  // can_bus_offs=0 can_restarts=0`, with ` can_says="words"` of the system's last refusal; and of
  // its frames ` can_malformed=0 can_foreign=0 can_unknown=0 can_unsent=0 can_unanswered=0
  // can_late_heartbeats=0 can_emergencies=0 can_repeated=0`. The same of a second bus, by keys that
  // begin with can2.
  void tell(controller::Line& line) const;

 private:
  std::atomic<bool> memory_locked_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<std::uint64_t> heap_calls_before_{0};
  std::atomic<std::int64_t> faults_before_{0};
  std::atomic<std::int64_t> servo_faults_before_{0};
  std::atomic<std::int64_t> servo_faults_{0};
  std::array<BusWatch, canopen::kMostBuses> buses_;
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<std::uint64_t> steps_{0};
  std::uint64_t seen_ticks_ = 0;
  std::uint64_t seen_steps_ = 0;
};

}  // namespace armsig::daemon
