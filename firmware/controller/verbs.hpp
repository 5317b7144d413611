// SPDX-License-Identifier: MIT
// What an operator may ask for: a table of verbs.
#pragma once

#include <optional>
#include <span>

#include "firmware/controller/check_sequence.hpp"
#include "firmware/controller/commit.hpp"
#include "firmware/controller/grid_sequence.hpp"
#include "firmware/controller/identification_sequence.hpp"
#include "firmware/controller/mover.hpp"
#include "firmware/controller/point_measurement.hpp"
#include "firmware/controller/references.hpp"
#include "firmware/controller/text.hpp"
#include "hal/clock.hpp"

namespace armsig::controller {

// What the verbs act on and tell about.
struct Controls {
  const Configuration& configuration;
  hal::Clock& clock;
  Link& link;
  Mover& mover;
  const PointMeasurement& measurement;
  IdentificationSequence& identification;
  GridSequence& grid;
  CheckSequence& check;
  Custody& custody;
  Commit& commit;
  References& references;
  const hal::Duration& longest_step;          // below zero: none is over yet
  std::optional<LinePlanning> planning = {};  // of the straight line that was asked for
  std::optional<MoveLook> looking = {};       // at the way of the joint move that was asked for
#ifndef ARMSIG_SMALL_IMAGE
  PersonName sender = {};  // of the candidate from outside; empty: not told
#endif

  // A sequence, a plan or a change of the store is under way.
  [[nodiscard]] bool are_busy() const {
    return identification.is_running() || grid.is_running() || check.is_running() || planning ||
           looking || commit.is_running();
  }
};

// When an operator is answered whose request was not refused at once.
struct Answer {
  enum class When : std::uint8_t {
    kNow,
    kTaken,    // by the tick: the command with `ticket`
    kPlanned,  // Controls::planning or looking, and then taken
    kStored,   // Controls::commit
  };
  When when = When::kNow;
  Ticket ticket = 0;
};

// A verb's values, or what a refusal is about, go to `out`.
using Handler = Result<Answer> (*)(Controls& controls, const Request& request, Line& out);

struct Verb {
  enum class Takes : std::uint8_t { kNothing, kKeys, kVerb };
  std::string_view name;
  Handler handler = nullptr;
  std::string_view help;
  Modes modes = kInAnyMode;  // others refuse it with kWrongMode
  bool alone = false;        // refused with kWrongMode while Controls::are_busy()
  bool only_asks = false;    // changes nothing
  bool referenced = false;   // refused with kUnreferenced while a joint is
  Takes takes = Takes::kNothing;
};

[[nodiscard]] std::span<const Verb> verbs();
// Null if there is none.
[[nodiscard]] const Verb* find_verb(std::string_view name);

// The key `pace`. A joint of 60 deg/s takes an hour and a half for a turn at the least: slower is a
// slip of the pen.
[[nodiscard]] constexpr bool is_pace(double pace) { return pace >= 1e-3 && pace <= 1; }

// ` modes=idle,holding`.
void tell_modes(const Modes& modes, Line& out);

// Error: kUnreferenced; which joints are goes to `out`.
[[nodiscard]] Result<void> referenced(const Controls& controls, Line& out);

// Handlers that stand in files of their own.
Result<Answer> move(Controls& controls, const Request& request, Line& out);
Result<Answer> accept(Controls& controls, const Request& request, Line& out);
Result<Answer> send(Controls& controls, const Request& request, Line& out);
Result<Answer> confirm(Controls& controls, const Request& request, Line& out);
Result<Answer> tell_status(Controls& controls, const Request& request, Line& out);
Result<Answer> tell_signature(Controls& controls, const Request& request, Line& out);
Result<Answer> tell_candidate(Controls& controls, const Request& request, Line& out);
Result<Answer> tell_log(Controls& controls, const Request& request, Line& out);

// What a candidate will be of that is measured, or confirmed, from now on.
[[nodiscard]] IdentificationSequence::Conditions conditions_of(const Controls& controls);

// What follows from a change of the store that was begun: the answer waits for its end.
[[nodiscard]] Result<Answer> when_stored(const Result<void>& begun);

// What follows from sending a command: the answer waits for the tick. Errors: kBusBusy (the tick
// has stopped).
[[nodiscard]] Result<Answer> when_taken(std::optional<Ticket> ticket);

}  // namespace armsig::controller
