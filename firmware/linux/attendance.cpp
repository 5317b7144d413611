// SPDX-License-Identifier: MIT
#include "firmware/linux/attendance.hpp"

#include <cstdio>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "hal/linux/steady_clock.hpp"

namespace armsig::daemon {
namespace {

BlackBoxConfiguration box_of(const DaemonConfiguration& c) {
  BlackBoxConfiguration box;
  const auto beside = std::filesystem::absolute(c.store).parent_path() / "black-box";
  box.folder = c.black_box.empty() ? beside.string() : c.black_box;
  box.name = c.name;
  for (const DhJoint& joint : c.controller.drawing.joints) box.joints.push_back(joint.type);
  box.period = c.controller.period;
  return box;
}

}  // namespace

Attendance::Attendance(const DaemonConfiguration& configuration, hal::Console& console,
                       hal::Console* reporting)
    : box_(box_of(configuration), journal_), logged_(console, journal_) {
  if (!configuration.touches.file.empty()) {
    touches_.emplace(configuration.controller, configuration.touches);
  }
  add(logged_);
  if (reporting != nullptr) add(asking_.emplace(*reporting, journal_));
}

void Attendance::add(hal::Console& console) {
  const std::size_t place = consoles_.size();
  hal::Console* inner = &console;
  if (touches_) inner = &touching_[place].emplace(console, *touches_);
  consoles_.push_back(&system_[place].emplace(*inner, watch_, box_));
}

void Attendance::begin(controller::Controller& controller) {
  if (touches_) touches_->attend(controller.state());
  controller.observe(box_);
  journal_.begin([this] { attend(); });
}

void Attendance::attend() {
  box_.write_if_due();
  if (touches_) touches_->write_if_due();
  if (watch_.progressed()) manager_.alive(linux_hal::monotonic_now());
}

void Attendance::started(const std::string& words) {
  fmt::print("armsigd: {}\n", words);
  (void)std::fflush(stdout);
  manager_.ready();
}

void Attendance::end(int signal, bool at_rest) {
  manager_.stopping();
  journal_.end();
  if (signal == 0) return;                         // it never ran
  const char* const name = ::sigdescr_np(signal);  // none of a real-time signal
  journal_.tell(at_rest ? Priority::kNotice : Priority::kError,
                fmt::format("ended by signal {} ({}): {}", signal, name == nullptr ? "-" : name,
                            at_rest ? "the drives are without torque"
                                    : "not every drive said that it is without torque"));
}

}  // namespace armsig::daemon
