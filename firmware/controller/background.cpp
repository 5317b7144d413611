// SPDX-License-Identifier: MIT
#include "firmware/controller/background.hpp"

#include <algorithm>

#include "core/base/error_name.hpp"

namespace armsig::controller {

Background::Background(const Configuration& configuration, hal::RangeSensor& sensor,
                       hal::Clock& clock, hal::NonvolatileMemory& memory,
                       std::span<hal::Console* const> consoles, Link& link)
    : configuration_(configuration),
      clock_(clock),
      link_(link),
      announcer_(consoles),
      mover_(link),
      measurement_(configuration, sensor),
      identification_(configuration, mover_, measurement_, announcer_),
      grid_(configuration, mover_, link, announcer_),
      custody_(configuration.drawing, memory),
      positions_(memory, custody_.sectors()) {
  custody_.load();
  link.models[0] = active() ? model_of(active()->signature, configuration.drawing)
                            : model_of(configuration.drawing);
}

bool Background::step() {
  const hal::Instant began = clock_.now();
  mover_.refresh();
  tell_changes();
  identification_.measure_step(measurement_.step(clock_.now()));
  identification_.step();
  grid_.step();
  step_store();
  step_planning();
  keep_positions();
  step_consoles();
  longest_step_ = std::max(longest_step_, clock_.now() - began);
  return measurement_.is_computing() || identification_.is_computing() || planning_;
}

void Background::tell_changes() {
  const Snapshot& snapshot = mover_.now();
  const std::uint32_t code = snapshot.fault ? snapshot.fault->code : 0;
  if (snapshot.mode == told_mode_ && code == told_code_) return;
  told_mode_ = snapshot.mode;
  told_code_ = code;
  Line line;
  line.text("# mode ").text(name(snapshot.mode));
  if (snapshot.fault) {
    line.reason(snapshot.fault->error);
    if (snapshot.fault->joint) line.text(" joint=").integer(*snapshot.fault->joint + 1);
    line.device_says(snapshot.fault->code, snapshot.fault->words);
  }
  announcer_.say(line);
  if (snapshot.mode == Mode::kIdle) {
    look_at_machine();
    look_at_positions();
  }
}

void Background::step_consoles() {
  if (waiting_) {
    if (!mover_.is_handled(waiting_ticket_)) return;
    client_ = *waiting_;
    waiting_.reset();
    out_.clear();
    const auto refusal = mover_.refusal(waiting_ticket_);
    reply(refusal ? Verdict(std::unexpected(*refusal)) : Verdict());
  }
  for (std::size_t i = 0; i < announcer_.count() && !waiting_; ++i) {
    client_.console = (turn_ + i) % announcer_.count();
    if (const auto line = announcer_.console(client_.console).read_line()) {
      client_.id = line->client;
      turn_ = client_.console + 1;
      answer(*line);
      return;
    }
  }
}

void Background::answer(const hal::ConsoleLine& line) {
  out_.clear();
  waits_ = stores_ = plans_ = false;
  if (line.error) {
    reply(std::unexpected(*line.error));
    return;
  }
  const auto request = parse_request(line.text());
  const Verdict verdict = request ? serve(*request) : std::unexpected(request.error());
  if (verdict && stores_) {
    storing_for_ = client_;
  } else if (verdict && plans_) {
    planning_for_ = client_;
  } else if (verdict && waits_) {
    waiting_ = client_;
  } else {
    reply(verdict);
  }
}

// A function of its own: its line would stand on the stack below all that a request calls.
[[gnu::noinline]] void Background::reply(const Verdict& verdict) {
  Line line;
  if (verdict) {
    line.text("ok").text(out_.view());
  } else {
    line.text("error ")
        .text(name(verdict.error()))
        .text(" ")
        .text(describe(verdict.error()))
        .text(out_.view());
  }
  (void)announcer_.console(client_.console).write_line(client_.id, line.view());
}

}  // namespace armsig::controller
