// SPDX-License-Identifier: MIT
#include "firmware/linux/process_watch.hpp"

#include <string.h>
#include <sys/resource.h>

#include "hal/linux/heap_calls.hpp"

namespace armsig::daemon {
namespace {

std::int64_t page_faults(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

std::string_view name_of(hal::CanState state) {
  switch (state) {
    case hal::CanState::kActive:
      return "active";
    case hal::CanState::kWarning:
      return "warning";
    case hal::CanState::kPassive:
      return "passive";
    case hal::CanState::kBusOff:
      return "bus-off";
    case hal::CanState::kDown:
      return "down";
  }
  return "unknown";
}

}  // namespace

void ProcessWatch::begin(const linux_hal::RealTimeReport& report, int priority) {
  memory_locked_ = !report.memory_not_locked;
  real_time_ = priority > 0 && !report.priority_not_given;
  heap_calls_before_ = linux_hal::heap_calls();
  faults_before_ = page_faults(RUSAGE_SELF);
  servo_faults_before_ = servo_faults_ = page_faults(RUSAGE_THREAD);
}

void ProcessWatch::look(const linux_hal::SocketCan* bus, const canopen::Master* master) {
  servo_faults_ = page_faults(RUSAGE_THREAD);
  if (bus == nullptr) return;
  look_at(bus->last_status(), bus->last_errno());
  if (master != nullptr) look_at(master->counters());
}

void ProcessWatch::look_at(const hal::CanStatus& status, int refusal) {
  can_state_ = status.state;
  can_error_frames_ = status.error_frames;
  can_lost_ = status.lost;
  can_bus_offs_ = status.bus_offs;
  can_restarts_ = status.restarts;
  can_errno_ = refusal;
  has_bus_ = true;
}

void ProcessWatch::look_at(const canopen::MasterCounters& counters) {
  can_malformed_ = counters.malformed;
  can_foreign_ = counters.foreign;
  can_unknown_ = counters.unknown;
  can_unsent_ = counters.unsent;
  can_unanswered_ = counters.unanswered;
  can_late_heartbeats_ = counters.late_heartbeats;
  can_emergencies_ = counters.emergencies;
  can_repeated_ = counters.repeated;
}

bool ProcessWatch::progressed() {
  const std::uint64_t ticks = ticks_;
  const std::uint64_t steps = steps_;
  if (ticks == seen_ticks_ || steps == seen_steps_) return false;
  seen_ticks_ = ticks;
  seen_steps_ = steps;
  return true;
}

void ProcessWatch::tell(controller::Line& line) const {
  const auto difference = [](std::int64_t now, std::int64_t before) {
    return static_cast<std::uint64_t>(now - before);
  };
  line.text(" memory_locked=").text(memory_locked_ ? "yes" : "no");
  line.text(" real_time=").text(real_time_ ? "yes" : "no");
  line.text(" heap_calls=").integer(linux_hal::heap_calls() - heap_calls_before_);
  line.text(" page_faults=").integer(difference(page_faults(RUSAGE_SELF), faults_before_));
  line.text(" servo_page_faults=").integer(difference(servo_faults_, servo_faults_before_));
  if (!has_bus_) return;
  line.text(" can=").text(name_of(can_state_));
  line.text(" can_error_frames=").integer(can_error_frames_);
  line.text(" can_lost=").integer(can_lost_);
  line.text(" can_bus_offs=").integer(can_bus_offs_);
  line.text(" can_restarts=").integer(can_restarts_);
  line.text(" can_malformed=").integer(can_malformed_);
  line.text(" can_foreign=").integer(can_foreign_);
  line.text(" can_unknown=").integer(can_unknown_);
  line.text(" can_unsent=").integer(can_unsent_);
  line.text(" can_unanswered=").integer(can_unanswered_);
  line.text(" can_late_heartbeats=").integer(can_late_heartbeats_);
  line.text(" can_emergencies=").integer(can_emergencies_);
  line.text(" can_repeated=").integer(can_repeated_);
  const int number = can_errno_;
  const char* const words = number == 0 ? nullptr : ::strerrordesc_np(number);
  if (words != nullptr) line.text(" can_says=\"").text(words).text("\"");
}

}  // namespace armsig::daemon
