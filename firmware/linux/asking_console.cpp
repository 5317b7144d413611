// SPDX-License-Identifier: MIT
#include "firmware/linux/asking_console.hpp"

#include "firmware/controller/text.hpp"
#include "firmware/controller/verbs.hpp"
#include "firmware/linux/touch_recorder.hpp"

namespace armsig::daemon {

bool only_asks(std::string_view request) {
  const std::string_view name = request.substr(0, request.find_first_of(" \t"));
  const controller::Verb* verb = controller::find_verb(name);
  if (verb != nullptr) return verb->only_asks;
  const TouchVerb* touching = find_touch_verb(name);
  return touching != nullptr ? touching->only_asks : name == "system";
}

// At most one line is looked at each time: a flood of refused requests costs a tick no more than
// answered ones do.
std::optional<hal::ConsoleLine> AskingConsole::do_read_line() {
  auto line = inner_.read_line();
  if (!line || line->error || only_asks(line->text())) return line;
  const std::string_view request = line->text();
  journal_.say(Priority::kWarning, controller::Line()
                                       .text("reporting console ")
                                       .integer(line->client)
                                       .text(" is refused: ")
                                       .text(request.substr(0, request.find(" hex=")))
                                       .view());
  (void)inner_.write_line(
      line->client,
      "error NOT_PERMITTED \"this console answers only requests that change nothing\"");
  return std::nullopt;
}

}  // namespace armsig::daemon
