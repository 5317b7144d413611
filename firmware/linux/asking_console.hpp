// SPDX-License-Identifier: MIT
// A console for processes that report: it answers requests that change nothing and refuses all
// others.
#pragma once

#include <string_view>

#include "firmware/linux/journal.hpp"
#include "hal/console.hpp"

namespace armsig::daemon {

// Whether `request` changes nothing. A line that is no request of the controller's does not count
// as one.
[[nodiscard]] bool only_asks(std::string_view request);

class AskingConsole final : public hal::Console {
 public:
  // Both outlive the console. Every refused request is a warning in the journal.
  AskingConsole(hal::Console& inner, Journal& journal) : inner_(inner), journal_(journal) {}

 private:
  std::optional<hal::ConsoleLine> do_read_line() override;
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override {
    return inner_.write_line(client, text);
  }
  void do_broadcast(std::string_view text) override { inner_.broadcast(text); }

  hal::Console& inner_;
  Journal& journal_;
};

}  // namespace armsig::daemon
