// SPDX-License-Identifier: MIT
#include "firmware/controller/desk.hpp"

#include <type_traits>

#include "core/base/error_name.hpp"

namespace armsig::controller {
namespace {

// Precondition: are_busy().
std::string_view under_way(const Controls& controls) {
  if (controls.identification.is_running()) return "identify";
  if (controls.grid.is_running()) return "touch-grid";
  if (controls.check.is_running()) return "check";
  return controls.commit.is_running() ? "a change of the store" : "the planning of a move";
}

// Whether the mode, and what is under way, let the verb be asked for; why not goes to `out`.
Result<void> allowed_now(const Verb& verb, const Controls& controls, Line& out) {
  const Mode mode = controls.mover.now().mode;
  const bool in_mode = verb.modes.contains(mode);
  if (in_mode && !(verb.alone && controls.are_busy())) return {};
  out.text(" mode=").text(name(mode));
  tell_modes(verb.modes, out);
  if (in_mode) out.text(" why=\"").text(under_way(controls)).text(" is under way\"");
  return std::unexpected(Error::kWrongMode);
}

}  // namespace

Desk::Desk(const Announcer& announcer, const Controls& controls)
    : announcer_(announcer), controls_(controls) {}

void Desk::step() {
  step_planning();
  if (waiting_) {
    if (!controls_.mover.is_handled(waiting_->ticket)) return;
    const auto refusal = controls_.mover.refusal(waiting_->ticket);
    out_.clear();
    if (waiting_->missed_rad && !refusal) out_.orientation_missed(*waiting_->missed_rad);
    // The mode has changed since the verb was looked at, or the arm is not where the move begins.
    if (refusal == Error::kWrongMode) out_.text(" mode=").text(name(controls_.mover.now().mode));
    reply(waiting_->client, refusal ? Result<void>(std::unexpected(*refusal)) : Result<void>(),
          out_);
    waiting_.reset();
  }
  take_request();
}

// The client waits until its line is planned, or the way of its move looked at, then until the tick
// has taken it. Whether the arm is still where the plan begins is for the tick to judge.
[[gnu::noinline]] void Desk::step_planning() {
  if (waiting_) return;
  step(controls_.planning);
  if constexpr (kMayBound) step(controls_.looking);
}

template <typename Planning>
void Desk::step(std::optional<Planning>& planning) {
  if (!planning || planning->step()) return;
  const Planned& planned = planning->result();
  out_.clear();
  if constexpr (kMayBound) {
    if (!planned && planned.error().error == Error::kOutsideWorkspace) {
      add_room(out_, planning->room());
    }
  }
  const auto answer = planned ? when_taken(controls_.mover.send(*planned))
                              : Result<Answer>(std::unexpected(planned.error().error));
  std::optional<double> missed_rad;
  if constexpr (std::is_same_v<Planning, LinePlanning>) {
    const auto& models = controls_.link.models;
    if (may_miss_orientation(models[controls_.mover.now().model])) {
      missed_rad = planning->missed_rad();
    }
  }
  planning.reset();
  settle(planning_for_, answer, out_);
  if (waiting_ && missed_rad) waiting_->missed_rad = missed_rad;
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
  if (auto allowed = allowed_now(*verb, controls_, out); !allowed) {
    return std::unexpected(allowed.error());
  }
  if (verb->referenced) {
    if (auto sure = referenced(controls_, out); !sure) return std::unexpected(sure.error());
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
