// SPDX-License-Identifier: MIT
// What attends a controller in a process: log, black box, service manager, and the console through
// which they hear of it.
#pragma once

#include <string>

#include "firmware/controller/controller.hpp"
#include "firmware/linux/black_box.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/linux/journal.hpp"
#include "firmware/linux/journal_console.hpp"
#include "firmware/linux/process_watch.hpp"
#include "firmware/linux/service_manager.hpp"
#include "firmware/linux/system_console.hpp"

namespace armsig::daemon {

class Attendance {
 public:
  // `console`, which outlives this, is the operators'.
  Attendance(const DaemonConfiguration& configuration, hal::Console& console);
  ~Attendance() { journal_.end(); }  // whose thread uses the others
  Attendance(const Attendance&) = delete;
  Attendance& operator=(const Attendance&) = delete;

  // For the controller.
  [[nodiscard]] hal::Console& console() { return system_; }
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

  Journal journal_;
  ProcessWatch watch_;
  BlackBox box_;
  JournalConsole logged_;
  SystemConsole system_;
  ServiceManager manager_;
};

}  // namespace armsig::daemon
