// SPDX-License-Identifier: MIT
#include "firmware/linux/journal_console.hpp"

#include "firmware/linux/asking_console.hpp"

namespace armsig::daemon {
namespace {

// A request as it is logged: what is sent in hexadecimal digits is no reading for people.
std::string_view without_bytes(std::string_view request) {
  return request.substr(0, request.find(" hex="));
}

Priority priority_of(std::string_view told) {
  if (told.starts_with("# mode faulted")) return Priority::kError;
  if (told.starts_with("# check verdict=") && !told.contains("as accepted")) {
    return Priority::kWarning;
  }
  for (const std::string_view trouble : {" ended ", " paused ", " lost ", " dropped "}) {
    if (told.find(trouble) != std::string_view::npos) return Priority::kWarning;
  }
  return told.starts_with("# mode ") ? Priority::kNotice : Priority::kInfo;
}

}  // namespace

std::optional<hal::ConsoleLine> JournalConsole::do_read_line() {
  auto line = inner_.read_line();
  // Screens ask many times a second.
  if (!line || line->error || only_asks(line->text())) return line;
  journal_.say(Priority::kNotice, controller::Line()
                                      .text("console ")
                                      .integer(line->client)
                                      .text(": ")
                                      .text(without_bytes(line->text()))
                                      .view());
  return line;
}

// A reply that carries values answers a question, but for what a line of the tool misses and for a
// touch; a refusal is told whatever was asked.
Result<void> JournalConsole::do_write_line(hal::ConsoleClient client, std::string_view text) {
  if (text == "ok" || text.starts_with("ok orientation_missed_deg=") ||
      text.starts_with("ok place=") || text.starts_with("error ")) {
    journal_.say(Priority::kNotice, controller::Line()
                                        .text("console ")
                                        .integer(client)
                                        .text(" is answered: ")
                                        .text(text)
                                        .view());
  }
  return inner_.write_line(client, text);
}

void JournalConsole::do_broadcast(std::string_view text) {
  journal_.say(priority_of(text), text.starts_with("# ") ? text.substr(2) : text);
  inner_.broadcast(text);
}

}  // namespace armsig::daemon
