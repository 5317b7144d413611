// SPDX-License-Identifier: MIT
#include "firmware/linux/process_watch.hpp"

#include <sys/resource.h>

#include "hal/linux/heap_calls.hpp"

namespace armsig::daemon {
namespace {

std::int64_t page_faults(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

}  // namespace

void ProcessWatch::begin(const linux_hal::RealTimeReport& report, int priority) {
  memory_locked_ = !report.memory_not_locked;
  real_time_ = priority > 0 && !report.priority_not_given;
  heap_calls_before_ = linux_hal::heap_calls();
  faults_before_ = page_faults(RUSAGE_SELF);
  servo_faults_before_ = servo_faults_ = page_faults(RUSAGE_THREAD);
}

void ProcessWatch::look() { servo_faults_ = page_faults(RUSAGE_THREAD); }

void ProcessWatch::tell(controller::Line& line) const {
  const auto difference = [](std::int64_t now, std::int64_t before) {
    return static_cast<std::uint64_t>(now - before);
  };
  line.text(" memory_locked=").text(memory_locked_ ? "yes" : "no");
  line.text(" real_time=").text(real_time_ ? "yes" : "no");
  line.text(" heap_calls=").integer(linux_hal::heap_calls() - heap_calls_before_);
  line.text(" page_faults=").integer(difference(page_faults(RUSAGE_SELF), faults_before_));
  line.text(" servo_page_faults=").integer(difference(servo_faults_, servo_faults_before_));
}

}  // namespace armsig::daemon
