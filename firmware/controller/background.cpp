// SPDX-License-Identifier: MIT
#include "firmware/controller/background.hpp"

#include <algorithm>

namespace armsig::controller {

Background::Background(const Configuration& configuration, hal::RangeSensor& sensor,
                       hal::Clock& clock, hal::NonvolatileMemory& memory,
                       std::span<hal::Console* const> consoles, Link& link, Refinement* refinement,
                       CheckMemory* checks)
    : configuration_(configuration),
      clock_(clock),
      link_(link),
      announcer_(consoles),
      mover_(link),
      measurement_(configuration, sensor),
      identification_(configuration, mover_, measurement_, announcer_, refinement),
      grid_(configuration, mover_, link, announcer_),
      custody_(configuration.drawing, memory),
      check_(configuration, mover_, measurement_, announcer_, link, custody_, checks),
      commit_(configuration, custody_, identification_, mover_, link),
      resting_place_(configuration.drawing, memory, custody_.sectors()),
      desk_(announcer_, {.configuration = configuration,
                         .clock = clock,
                         .link = link,
                         .mover = mover_,
                         .measurement = measurement_,
                         .identification = identification_,
                         .grid = grid_,
                         .check = check_,
                         .custody = custody_,
                         .commit = commit_,
                         .longest_step = longest_step_}) {}

bool Background::step() {
  const hal::Instant began = clock_.now();
  mover_.refresh();
  tell_changes();
  const auto measured = measurement_.step(clock_.now());
  identification_.measure_step(measured);
  check_.measure_step(measured);
  identification_.step();
  check_.step();
  grid_.step();
  if (const auto committed = commit_.step()) desk_.stored(*committed);
  resting_place_.step(mover_.now());
  desk_.step();
  check_.look_at_schedule(desk_.is_busy());
  longest_step_ = std::max(longest_step_, clock_.now() - began);
  return measurement_.is_computing() || identification_.is_computing() || desk_.is_computing();
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
  if (snapshot.mode == Mode::kIdle) look_at_machine();
}

// The drives have told who they are, and where.
void Background::look_at_machine() {
  const Machine& machine = link_.machine.read();
  if (machine.drives.size() == configuration_.drawing.joints.size()) custody_.compare(machine);
  custody_.tell_trouble(announcer_);
  resting_place_.compare(mover_.now().positions, announcer_);
}

}  // namespace armsig::controller
