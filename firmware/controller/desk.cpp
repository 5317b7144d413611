// SPDX-License-Identifier: MIT
#include "firmware/controller/desk.hpp"

#include "core/base/error_name.hpp"

namespace armsig::controller {

void Desk::step() {
  step_planning();
  if (waiting_) {
    if (!controls_.mover.is_handled(waiting_->ticket)) return;
    const auto refusal = controls_.mover.refusal(waiting_->ticket);
    out_.clear();
    reply(waiting_->client, refusal ? Result<void>(std::unexpected(*refusal)) : Result<void>(),
          out_);
    waiting_.reset();
  }
  take_request();
}

// The client waits until its line is planned, then until the tick has taken it. Whether the arm is
// still where the plan begins is for the tick to judge.
[[gnu::noinline]] void Desk::step_planning() {
  auto& planning = controls_.planning;
  if (!planning || waiting_ || planning->step()) return;
  const Planned& planned = planning->result();
  const auto answer = planned ? when_taken(controls_.mover.send(*planned))
                              : Result<Answer>(std::unexpected(planned.error().error));
  planning.reset();
  out_.clear();
  settle(planning_for_, answer, out_);
}

void Desk::take_request() {
  for (std::size_t i = 0; i < announcer_.count(); ++i) {
    const std::size_t console = (turn_ + i) % announcer_.count();
    const auto line = announcer_.console(console).read_line();
    if (!line) continue;
    turn_ = console + 1;
    out_.clear();
    settle({console, line->client}, serve(*line, out_), out_);
    return;
  }
}

Result<Answer> Desk::serve(const hal::ConsoleLine& line, Line& out) {
  if (line.error) return std::unexpected(*line.error);
  ARMSIG_TRY(request, parse_request(line.text()));
  const Verb* verb = find_verb(request.verb);
  if (verb == nullptr || (verb->takes != Verb::Takes::kKeys && !request.arguments.empty()) ||
      (verb->takes != Verb::Takes::kVerb && !request.subject.empty())) {
    return std::unexpected(Error::kUnknownRequest);
  }
  if (!verb->modes.contains(controls_.mover.now().mode) || (verb->alone && controls_.are_busy())) {
    return std::unexpected(Error::kWrongMode);
  }
  return verb->handler(controls_, request, out);
}

void Desk::settle(const Client& client, const Result<Answer>& answer, const Line& out) {
  if (!answer) {
    reply(client, std::unexpected(answer.error()), out);
    return;
  }
  switch (answer->when) {
    case Answer::When::kNow:
      reply(client, {}, out);
      break;
    case Answer::When::kTaken:
      waiting_ = {client, answer->ticket};
      break;
    case Answer::When::kPlanned:
      planning_for_ = client;
      break;
    case Answer::When::kStored:
      storing_for_ = client;
      break;
  }
}

void Desk::stored(const Result<void>& result) {
  if (!storing_for_) return;
  out_.clear();
  reply(*storing_for_, result, out_);
  storing_for_.reset();
}

// A function of its own: its line would stand on the stack below all that a request calls.
[[gnu::noinline]] void Desk::reply(const Client& client, const Result<void>& verdict,
                                   const Line& out) const {
  Line line;
  if (verdict) {
    line.text("ok");
  } else {
    line.text("error ").text(name(verdict.error())).text(" ").text(describe(verdict.error()));
  }
  line.text(out.view());
  (void)announcer_.console(client.console).write_line(client.id, line.view());
}

}  // namespace armsig::controller
