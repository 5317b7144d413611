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
      store_(memory) {
  load();
  link.models[0] = active_ ? model_of(active_->signature, configuration.drawing)
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
  step_consoles();
  longest_step_ = std::max(longest_step_, clock_.now() - began);
  return measurement_.is_computing() || identification_.is_computing();
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
}

// What the store has now; nothing where it has nothing that can be read.
void Background::load() {
  if (!active_) active_.emplace();
  store_error_.reset();
  if (const auto loaded = store_.load(configuration_.drawing, *active_); !loaded) {
    active_.reset();
    if (loaded.error() != Error::kNoSignature) store_error_ = loaded.error();
  }
}

// The servo takes over what is active, so that it is never other than what the status says.
void Background::adopt() {
  model_ = 1 - mover_.now().model;
  link_.models[model_] = active_ ? model_of(active_->signature, configuration_.drawing)
                                 : model_of(configuration_.drawing);
  storing_ = Storing::kAdopting;
}

void Background::step_store() {
  if (storing_ == Storing::kNothing) return;
  Result<void> result;
  if (storing_ == Storing::kWriting) {
    const auto written = store_.step_write();
    if (written && !*written) return;
    if (written) {
      load();
      identification_.forget_candidate();
      adopt();
      return;
    }
    result = std::unexpected(written.error());
    storing_ = Storing::kNothing;
  } else {
    if (mover_.now().model != model_) {
      Command command;
      command.kind = CommandKind::kAdoptModel;
      command.model = model_;
      if (mover_.is_handled()) mover_.send(command);
      return;
    }
    if (store_error_) result = std::unexpected(*store_error_);
    storing_ = Storing::kNothing;
  }
  if (!storing_for_) return;
  client_ = *storing_for_;
  storing_for_.reset();
  out_.clear();
  reply(result);
}

void Background::step_consoles() {
  if (waiting_) {
    if (!mover_.is_handled()) return;
    client_ = *waiting_;
    waiting_.reset();
    out_.clear();
    const auto refusal = mover_.refusal();
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
  waits_ = stores_ = false;
  if (line.error) {
    reply(std::unexpected(*line.error));
    return;
  }
  const auto request = parse_request(line.text());
  const Verdict verdict = request ? serve(*request) : std::unexpected(request.error());
  if (verdict && stores_) {
    storing_for_ = client_;
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
