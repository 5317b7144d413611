// SPDX-License-Identifier: MIT
// A console whose traffic is logged: what operators command, what they are answered, and what the
// controller says unasked (modes, faults, sequences).
#pragma once

#include <array>
#include <string_view>

#include "firmware/controller/text.hpp"
#include "firmware/linux/journal.hpp"
#include "hal/console.hpp"

namespace armsig::daemon {

class JournalConsole final : public hal::Console {
 public:
  // Both outlive the console.
  JournalConsole(hal::Console& inner, Journal& journal) : inner_(inner), journal_(journal) {}

 private:
  std::optional<hal::ConsoleLine> do_read_line() override;
  Result<void> do_write_line(hal::ConsoleClient client, std::string_view text) override;
  void do_broadcast(std::string_view text) override;

  hal::Console& inner_;
  Journal& journal_;
};

}  // namespace armsig::daemon
