// SPDX-License-Identifier: MIT
// A console that answers requests about touches itself, and adds them to the reply to `help`;
// everything else is the controller's.
#pragma once

#include <string_view>

#include "firmware/linux/touch_recorder.hpp"
#include "hal/console.hpp"

namespace armsig::daemon {

class TouchConsole final : public hal::Console {
 public:
  // Both outlive the console. Several consoles may have one recorder.
  TouchConsole(hal::Console& inner, TouchRecorder& recorder) : inner_(inner), recorder_(recorder) {}

 private:
  std::optional<hal::ConsoleLine> do_read_line() override;
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override;
  void do_broadcast(std::string_view text) override { inner_.broadcast(text); }

  hal::Console& inner_;
  TouchRecorder& recorder_;
};

}  // namespace armsig::daemon
