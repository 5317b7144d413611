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

void BusWatch::look(const hal::CanStatus& status, int refusal) {
  state = status.state;
  error_frames = status.error_frames;
  lost = status.lost;
  bus_offs = status.bus_offs;
  restarts = status.restarts;
  last_errno = refusal;
  is_real = true;
}

void BusWatch::look(const canopen::MasterCounters& counters) {
  malformed = counters.malformed;
  foreign = counters.foreign;
  unknown = counters.unknown;
  unsent = counters.unsent;
  unanswered = counters.unanswered;
  late_heartbeats = counters.late_heartbeats;
  emergencies = counters.emergencies;
  repeated = counters.repeated;
}

void BusWatch::tell(controller::Line& line, std::string_view number) const {
  if (!is_real) return;
  const auto begin = [&](std::string_view key) -> controller::Line& {
    return line.text(" can").text(number).text(key.substr(3)).text("=");
  };
  begin("can").text(name_of(state));
  begin("can_error_frames").integer(error_frames);
  begin("can_lost").integer(lost);
  begin("can_bus_offs").integer(bus_offs);
  begin("can_restarts").integer(restarts);
  begin("can_malformed").integer(malformed);
  begin("can_foreign").integer(foreign);
  begin("can_unknown").integer(unknown);
  begin("can_unsent").integer(unsent);
  begin("can_unanswered").integer(unanswered);
  begin("can_late_heartbeats").integer(late_heartbeats);
  begin("can_emergencies").integer(emergencies);
  begin("can_repeated").integer(repeated);
  const int says = last_errno;
  const char* const words = says == 0 ? nullptr : ::strerrordesc_np(says);
  if (words != nullptr) begin("can_says").text("\"").text(words).text("\"");
}

void ProcessWatch::look(std::span<linux_hal::SocketCan* const> buses,
                        const canopen::Master* master) {
  servo_faults_ = page_faults(RUSAGE_THREAD);
  for (std::size_t i = 0; i < buses.size(); ++i) {
    buses_[i].look(buses[i]->last_status(), buses[i]->last_errno());
    if (master != nullptr) buses_[i].look(master->counters(static_cast<std::uint8_t>(i)));
  }
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
  buses_[0].tell(line, "");
  buses_[1].tell(line, "2");
}

}  // namespace armsig::daemon
