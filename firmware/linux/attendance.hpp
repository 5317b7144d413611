// SPDX-License-Identifier: MIT
// What attends a controller in a process: log, black box, service manager, and the consoles through
// which they hear of it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>

#include "core/base/fixed_vector.hpp"
#include "firmware/controller/controller.hpp"
#include "firmware/linux/asking_console.hpp"
#include "firmware/linux/black_box.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/linux/journal.hpp"
#include "firmware/linux/journal_console.hpp"
#include "firmware/linux/process_watch.hpp"
#include "firmware/linux/service_manager.hpp"
#include "firmware/linux/system_console.hpp"
#include "firmware/linux/touch_console.hpp"
#include "firmware/linux/touch_recorder.hpp"

namespace armsig::daemon {

class Attendance {
 public:
  // Both outlive this. `console` is the operators'; `reporting`, or null, that of processes which
  // only ask.
  Attendance(const DaemonConfiguration& configuration, hal::Console& console,
             hal::Console* reporting);
  ~Attendance() { journal_.end(); }  // whose thread uses the others
  Attendance(const Attendance&) = delete;
  Attendance& operator=(const Attendance&) = delete;

  // For the controller.
  [[nodiscard]] std::span<hal::Console* const> consoles() const {
    return {consoles_.data(), consoles_.size()};
  }
  [[nodiscard]] ProcessWatch& watch() { return watch_; }
  [[nodiscard]] Journal& journal() { return journal_; }

  // Before the first tick. Throws std::system_error where there is no thread to have.
  void begin(controller::Controller& controller);
  // The first tick is about to come; `words` on standard output.
  void started(const std::string& words);
  // The ticks are over, by `signal`: `at_rest` tells what became of the arm.
  void end(int signal, bool at_rest);

 private:
  void attend();
  // What answers beside the controller, before `console`.
  void add(hal::Console& console);

  Journal journal_;
  ProcessWatch watch_;
  BlackBox box_;
  std::optional<TouchRecorder> touches_;
  JournalConsole logged_;
  std::optional<AskingConsole> asking_;
  std::array<std::optional<TouchConsole>, 2> touching_;
  std::array<std::optional<SystemConsole>, 2> system_;
  FixedVector<hal::Console*, 2> consoles_;
  ServiceManager manager_;
};

}  // namespace armsig::daemon
