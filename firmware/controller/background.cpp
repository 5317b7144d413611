// SPDX-License-Identifier: MIT
#include "firmware/controller/background.hpp"

#include <algorithm>

#include "firmware/controller/fault_words.hpp"

namespace armsig::controller {
namespace {

void tell_fault(Line& line, const Fault& fault) {
  line.reason(fault.error);
  if (fault.joint) line.text(" joint=").integer(*fault.joint + 1);
  line.device_object(fault.object);
  tell_words(line, fault);
  line.device_details(fault.details);
}

}  // namespace

Background::Background(const Configuration& configuration, Instrument instrument, hal::Clock& clock,
                       hal::NonvolatileMemory& memory, std::span<hal::Console* const> consoles,
                       Link& link, Refinement* refinement, CheckMemory* checks)
    : configuration_(configuration),
      clock_(clock),
      link_(link),
      announcer_(consoles),
      mover_(link),
      measurement_(configuration, instrument),
      identification_(configuration, mover_, measurement_, announcer_, refinement),
      grid_(configuration, mover_, link, announcer_),
      custody_(configuration.drawing, memory),
      check_(configuration, mover_, measurement_, announcer_, link, custody_, checks),
      commit_(configuration, custody_, identification_, mover_, link),
      references_(configuration, memory, custody_.sectors()),
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
                         .references = references_,
                         .longest_step = longest_step_}) {}

bool Background::step() {
  const hal::Instant began = clock_.now();
  mover_.refresh();
  tell_changes();
  if constexpr (!hal::kSmallImage) {
    tell_faults();
    tell_information();
  }
  const auto measured = measurement_.step(clock_.now());
  identification_.measure_step(measured);
  check_.measure_step(measured);
  identification_.step();
  check_.step();
  if (check_.take_accepted()) references_.take_check(announcer_);
  grid_.step();
  if (const auto committed = commit_.step()) desk_.stored(*committed);
  if (!references_.step(mover_.now(), announcer_)) desk_.step();
  check_.look_at_schedule(desk_.is_busy() || references_.unreferenced() != 0);
  longest_step_ = std::max(longest_step_, clock_.now() - began);
  return measurement_.is_computing() || identification_.is_computing() || desk_.is_computing();
}

void Background::tell_changes() {
  const Snapshot& snapshot = mover_.now();
  const std::uint32_t code = snapshot.fault ? snapshot.fault->code : 0;
  const std::uint32_t waits_for = snapshot.waits_for();
  const bool waits_on = waits_for == 0 || waits_for == told_wait_;
  if (snapshot.mode == told_mode_ && code == told_code_ && waits_on) return;
  const bool set_up = told_mode_ == Mode::kStarting;
  told_mode_ = snapshot.mode;
  if constexpr (!hal::kSmallImage) told_wait_ = waits_for;
  told_code_ = code;
  Line line;
  line.text("# mode ").text(name(snapshot.mode));
  if (snapshot.fault) tell_fault(line, *snapshot.fault);
  announcer_.say(line);
  if (snapshot.mode != Mode::kIdle) return;
  if (set_up) tell_gaps();
  look_at_machine(set_up);
}

// Of every drive that has one, but for the one that the mode was told with; once.
void Background::tell_faults() {
  const std::optional<Fault>& first = mover_.now().fault;
  if (mover_.now().mode == Mode::kIdle) told_faults_ = {};
  if (!first) return;
  for (const Fault& fault : link_.faults.read()) {
    const auto what = std::pair(fault.error, fault.code);
    auto& told = told_faults_[*fault.joint];
    if (told == what) continue;
    told = what;
    const bool is_first = first->joint == fault.joint && first->error == fault.error;
    if (is_first) continue;
    Line line;
    tell_fault(line.text("# drive faulted"), fault);
    announcer_.say(line);
  }
}

// What a drive has said that stopped nothing; the same code once.
void Background::tell_information() {
  for (const DriveInformation& information : link_.information.read()) {
    std::uint32_t& told = told_information_[information.joint];
    if (told == information.code) continue;
    told = information.code;
    Line line;
    line.text("# drive informs joint=").integer(information.joint + 1);
    line.device_says(information.code, information.words);
    announcer_.say(line.device_details(information.details));
  }
}

// What drives go without.
void Background::tell_gaps() {
  for (const DriveGap& gap : link_.gaps.read()) {
    Line line;
    line.text("# drive goes_without joint=").integer(gap.joint + 1).device_object(gap.object);
    announcer_.say(line);
  }
  if (mover_.now().unsupervised == 0) return;
  Line line;
  line.text("# drive unsupervised joints=").numbers(mover_.now().unsupervised);
  announcer_.say(line.reason(Error::kDriveUnsupervised));
}

// The drives have told who they are, and where.
void Background::look_at_machine(bool set_up) {
  const Machine& machine = link_.machine.read();
  if (machine.drives.size() == configuration_.drawing.joints.size()) {
    custody_.compare(machine);
    identification_.compare_conditions(machine, custody_.in_use());
  }
  custody_.tell_trouble(announcer_);
  if (set_up) references_.compare(mover_.now(), machine, custody_.in_use(), announcer_);
}

}  // namespace armsig::controller
