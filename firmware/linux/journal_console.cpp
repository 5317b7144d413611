// SPDX-License-Identifier: MIT
#include "firmware/linux/journal_console.hpp"

#include "firmware/controller/verbs.hpp"

namespace armsig::daemon {
namespace {

// Requests that change nothing, which screens ask for many times a second.
bool only_asks(std::string_view request) {
  const std::string_view name = request.substr(0, request.find_first_of(" \t"));
  const controller::Verb* verb = controller::find_verb(name);
  return verb != nullptr ? verb->only_asks : name == "system";
}

// A request as it is logged: what is sent in hexadecimal digits is no reading for people.
std::string_view without_bytes(std::string_view request) {
  return request.substr(0, request.find(" hex="));
}

Priority priority_of(std::string_view told) {
  if (told.starts_with("# mode faulted")) return Priority::kError;
  if (told.starts_with("# check verdict=") && !told.contains("as accepted")) {
    return Priority::kWarning;
  }
  for (const std::string_view trouble : {" ended ", " paused ", " lost "}) {
    if (told.find(trouble) != std::string_view::npos) return Priority::kWarning;
  }
  return told.starts_with("# mode ") ? Priority::kNotice : Priority::kInfo;
}

}  // namespace

std::optional<hal::ConsoleLine> JournalConsole::do_read_line() {
  auto line = inner_.read_line();
  if (!line || line->error || only_asks(line->text())) return line;
  journal_.say(Priority::kNotice, controller::Line()
                                      .text("console ")
                                      .integer(line->client)
                                      .text(": ")
                                      .text(without_bytes(line->text()))
                                      .view());
  return line;
}

// A reply that carries values answers a question; a refusal is told whatever was asked.
Result<void> JournalConsole::do_write_line(hal::ConsoleClient client, std::string_view text) {
  if (text == "ok" || text.starts_with("error ")) {
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
