// SPDX-License-Identifier: MIT
// A console that answers `system` itself, about the process; everything else is the controller's.
#pragma once

#include "firmware/linux/process_watch.hpp"
#include "hal/console.hpp"

namespace armsig::daemon {

class SystemConsole final : public hal::Console {
 public:
  // Both outlive the console.
  SystemConsole(hal::Console& inner, const ProcessWatch& watch) : inner_(inner), watch_(watch) {}

 private:
  std::optional<hal::ConsoleLine> do_read_line() override {
    auto line = inner_.read_line();
    if (!line || line->error || line->text() != "system") return line;
    controller::Line reply;
    reply.text("ok");
    watch_.tell(reply);
    (void)inner_.write_line(line->client, reply.view());
    return std::nullopt;
  }
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override {
    return inner_.write_line(client, text);
  }
  void do_broadcast(std::string_view text) override { inner_.broadcast(text); }

  hal::Console& inner_;
  const ProcessWatch& watch_;
};

}  // namespace armsig::daemon
