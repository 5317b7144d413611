// SPDX-License-Identifier: MIT
#include "firmware/linux/touch_console.hpp"

#include "firmware/controller/text.hpp"
#include "firmware/controller/verbs.hpp"

namespace armsig::daemon {

std::optional<hal::ConsoleLine> TouchConsole::do_read_line() {
  recorder_.step();
  auto line = inner_.read_line();
  if (!line || line->error) return line;
  const auto request = controller::parse_request(line->text());
  if (!request) return line;
  if (const TouchVerb* const verb = find_touch_verb(request->verb)) {
    recorder_.serve(*verb, *request, inner_, line->client);
    return std::nullopt;
  }
  const TouchVerb* const subject = find_touch_verb(request->subject);
  if (request->verb != "help" || subject == nullptr) return line;
  controller::Line reply;
  reply.text("ok verb=").text(subject->name);
  controller::tell_modes(subject->modes, reply);
  reply.text(" alone=no does=\"").text(subject->help).text("\"");
  (void)inner_.write_line(line->client, reply.view());
  return std::nullopt;
}

// The controller's own list, and these verbs.
Result<void> TouchConsole::do_write_line(hal::ConsoleClient client, std::string_view text) {
  if (!text.starts_with("ok verbs=")) return inner_.write_line(client, text);
  controller::Line reply;
  reply.text(text);
  for (const TouchVerb& verb : touch_verbs()) reply.text(",").text(verb.name);
  return inner_.write_line(client, reply.view());
}

}  // namespace armsig::daemon
