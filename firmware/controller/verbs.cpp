// SPDX-License-Identifier: MIT
#include "firmware/controller/verbs.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "firmware/controller/fetching.hpp"

namespace armsig::controller {
namespace {

// Of a refinement: nobody refines to less than this, or for longer than three days.
constexpr double kCoarsest_mm = 100;
constexpr double kLongest_minutes = 4320;

template <CommandKind kKind>
Result<Answer> command(Controls& controls, const Request& /*request*/, Line& /*out*/) {
  return when_taken(controls.mover.send(kKind));
}

struct RefiningRequest {
  double accuracy_mm = 0;  // 0: not asked for
  double minutes = 30;
  bool anew = false;
};

// The key `pace`, which a small image does not know.
Result<double> pace_in([[maybe_unused]] const Request& request, [[maybe_unused]] Line& out) {
  double pace = 1;
  if constexpr (!hal::kSmallImage) {
    for (const auto& [key, text] : request.arguments) {
      if (key != "pace") continue;
      ARMSIG_TRY(told, needed_number(key, text, out));
      if (!is_pace(told)) return std::unexpected(Error::kOutOfRange);
      pace = told;
    }
  }
  return pace;
}

Result<RefiningRequest> refining_in(const Request& request, Line& out) {
  RefiningRequest asked;
  bool paced = false;  // as any identification may be
  for (const auto& [key, text] : request.arguments) {
    if (key == "anew") {
      if (text != "yes" && text != "no") return std::unexpected(Error::kOutOfRange);
      asked.anew = text == "yes";
      continue;
    }
    if (!hal::kSmallImage && key == "pace") {
      paced = true;
      continue;
    }
    const bool accuracy = key == "accuracy_mm";
    if (!accuracy && key != "minutes") return std::unexpected(Error::kUnknownRequest);
    ARMSIG_TRY(value, needed_number(key, text, out));
    const double most = accuracy ? kCoarsest_mm : kLongest_minutes;
    if (!(value > 0 && value <= most)) return std::unexpected(Error::kOutOfRange);
    (accuracy ? asked.accuracy_mm : asked.minutes) = value;
  }
  const std::size_t others = request.arguments.size() - (paced ? 1 : 0);
  if (asked.accuracy_mm == 0 && others > 0) return std::unexpected(Error::kUnknownRequest);
  return asked;
}

// Error: kNoSensor.
Result<void> may_measure(const Controls& controls) {
  if (controls.measurement.has_instrument()) return {};
  return std::unexpected(Error::kNoSensor);
}

Result<Answer> identify(Controls& controls, const Request& request, Line& out) {
  if constexpr (kMayTakePoints) {
    if (auto may = may_measure(controls); !may) return std::unexpected(may.error());
  }
  ARMSIG_TRY(pace, pace_in(request, out));
  ARMSIG_TRY(asked, refining_in(request, out));
  const bool refines = asked.accuracy_mm > 0;
  if (refines && !controls.identification.can_refine()) {
    out.text(
        " why=\"no memory here to refine in: identify, fetch log.csv, refine at a workstation, "
        "send\"");
    return std::unexpected(Error::kUnsupported);
  }
  ARMSIG_TRY(answer, when_taken(controls.mover.begin_sequence(pace)));
  const auto conditions = conditions_of(controls);
  if (kMayRefine && refines) {
    const auto time = std::chrono::duration_cast<hal::Duration>(
        std::chrono::duration<double, std::ratio<60>>(asked.minutes));
    controls.identification.begin_refining({1e-3 * asked.accuracy_mm, time, asked.anew}, conditions,
                                           answer.ticket);
  } else {
    controls.identification.begin(conditions, answer.ticket);
  }
  return answer;
}

template <bool kPauses>
Result<Answer> pause(Controls& controls, const Request& /*request*/, Line& out) {
  if (!controls.identification.is_running()) {
    out.text(" why=\"identify is not under way\"");
    return std::unexpected(Error::kWrongMode);
  }
  kPauses ? controls.identification.pause() : controls.identification.resume();
  return Answer();
}

Result<Answer> touch_grid(Controls& controls, const Request& /*request*/, Line& /*out*/) {
  if (controls.custody.needs_acknowledgement()) {
    return std::unexpected(Error::kDrawingUnacknowledged);
  }
  if (auto begun = controls.grid.begin(); !begun) return std::unexpected(begun.error());
  const auto answer = when_taken(controls.mover.begin_sequence());
  if (answer) {
    controls.grid.begun(answer->ticket);
  } else {
    controls.grid.end(answer.error());
  }
  return answer;
}

Result<Answer> check_arm(Controls& controls, const Request& /*request*/, Line& out) {
  if constexpr (kMayTakePoints) {
    if (auto may = may_measure(controls); !may) return std::unexpected(may.error());
  }
  if (!controls.references.may_check()) {
    if (auto sure = referenced(controls, out); !sure) return std::unexpected(sure.error());
  }
  ARMSIG_TRY(ticket, controls.check.begin());
  return when_taken(ticket);
}

Result<Answer> halt(Controls& controls, const Request& /*request*/, Line& /*out*/) {
  controls.check.postpone();
  return when_taken(controls.mover.send(CommandKind::kHalt));
}

// Error: kUnsupported, with the reason.
Result<void> may_home(const Configuration& configuration, std::size_t joint, Line& out) {
  const bool homes = configuration.reference(joint) == Reference::kHomed;
  const bool coupled =
      std::ranges::any_of(configuration.drawing.couplings, [&](const JointCoupling& coupling) {
        return coupling.joint == joint || coupling.from == joint;
      });
  if (homes && !coupled) return {};
  out.text(" joint=").integer(joint + 1);
  out.text(homes ? " why=\"its motor moves another joint, too: home it by the tool of its maker\""
                 : " why=\"its configuration does not say reference: homed\"");
  return std::unexpected(Error::kUnsupported);
}

// `home joint=2`.
Result<Answer> home(Controls& controls, const Request& request, Line& out) {
  if (request.arguments.size() != 1 || request.arguments[0].first != "joint") {
    out.text(" why=\"home joint=2\"");
    return std::unexpected(Error::kUnknownRequest);
  }
  ARMSIG_TRY(number, needed_number("joint", request.arguments[0].second, out));
  const auto joints = static_cast<double>(controls.configuration.drawing.joints.size());
  if (!(number >= 1 && number <= joints) || number != std::floor(number)) {
    return std::unexpected(Error::kOutOfRange);
  }
  Command command;
  command.kind = CommandKind::kHome;
  command.index = static_cast<std::size_t>(number) - 1;
  if (auto may = may_home(controls.configuration, command.index, out); !may) {
    return std::unexpected(may.error());
  }
  return when_taken(controls.mover.send(command));
}

Result<Answer> rollback(Controls& controls, const Request& /*request*/, Line& /*out*/) {
  return when_stored(controls.commit.begin_rollback());
}

Result<Answer> acknowledge(Controls& controls, const Request& /*request*/, Line& out) {
  if (!controls.custody.needs_acknowledgement()) {
    out.text(" why=\"nothing is to be acknowledged\"");
    return std::unexpected(Error::kWrongMode);
  }
  controls.custody.acknowledge();
  out.text(" model=nominal");
  return Answer();
}

Result<Answer> fetch(Controls& controls, const Request& request, Line& out) {
  const auto& identification = controls.identification;
  const auto told =
      tell_part(request,
                {.signature = controls.custody.in_use(),
                 .candidate = identification.has_verdict() ? &*identification.candidate() : nullptr,
                 .drawing = &controls.configuration.drawing},
                out);
  if (!told) return std::unexpected(told.error());
  return Answer();
}

Result<Answer> compare(Controls& controls, const Request& /*request*/, Line& /*out*/) {
  if constexpr (kMayTakePoints) {
    if (auto may = may_measure(controls); !may) return std::unexpected(may.error());
  }
  if (!controls.identification.has_received()) return std::unexpected(Error::kNoCandidate);
  ARMSIG_TRY(answer, when_taken(controls.mover.begin_sequence()));
  controls.identification.begin_comparison(conditions_of(controls), answer.ticket);
  return answer;
}

Result<Answer> help(Controls& /*controls*/, const Request& request, Line& out) {
  if (request.subject.empty()) {
    out.text(" verbs=");
    for (const Verb& verb : verbs()) out.text(&verb == verbs().data() ? "" : ",").text(verb.name);
    return Answer();
  }
  const Verb* verb = find_verb(request.subject);
  if (verb == nullptr) return std::unexpected(Error::kUnknownRequest);
  out.text(" verb=").text(verb->name);
  tell_modes(verb->modes, out);
  out.text(" alone=").text(verb->alone ? "yes" : "no");
  out.text(" does=\"").text(verb->help).text("\"");
  return Answer();
}

// A verb that is a command to the tick.
template <CommandKind kKind>
constexpr Verb tick_verb(std::string_view name, std::string_view help) {
  return {.name = name, .handler = command<kKind>, .help = help, .modes = modes_of(kKind)};
}

constexpr Modes kStanding{Mode::kIdle, Mode::kHolding};
constexpr Modes kReady{Mode::kHolding};
constexpr Modes kBetweenSequences{Mode::kStarting, Mode::kIdle, Mode::kHolding, Mode::kServoing,
                                  Mode::kFaulted};

constexpr std::array kVerbsOfAll{
    Verb{.name = "status",
         .handler = tell_status,
         .help = "mode, fault, readings, tool, sensor, sequence, times",
         .only_asks = true},
    tick_verb<CommandKind::kEnable>("enable", "torque on"),
    tick_verb<CommandKind::kDisable>("disable", "the arm is brought to rest, then torque off"),
    tick_verb<CommandKind::kReset>("reset", "forgets a fault; sets up again, without torque"),
    tick_verb<CommandKind::kStop>(
        "stop", "quick stop of every drive, faulted until reset; not an emergency stop"),
    Verb{.name = "halt",
         .handler = halt,
         .help = "slows down on the path, ends a sequence; torque stays; puts off a check that is "
                 "due",
         .modes = modes_of(CommandKind::kHalt)},
    Verb{.name = "move",
         .handler = move,
         .help = "q1_deg=10 q3_mm=5 moves joints, dq1_deg=1 by so much; x_mm= y_mm= z_mm= qw= qx= "
                 "qy= qz= or dx_mm= ... "
                 "moves the tool in a straight line; pace=0.5 slows down",
         .modes = kReady,
         .alone = true,
         .takes = Verb::Takes::kKeys},
    Verb{
        .name = "identify",
        .handler = identify,
        .help = kMayRefine
                    ? "measures all joints; ends with a candidate; accuracy_mm=0.15 minutes=30 "
                      "finds gravity and joint error maps, too, from poses of its own "
                      "choice; goes on where one was interrupted, but for anew=yes; pace=0.1 slows "
                      "down"
                    : "measures all joints; ends with a candidate",
        .modes = kReady,
        .alone = true,
        .referenced = true,
        .takes = Verb::Takes::kKeys},
    Verb{.name = "check",
         .handler = check_arm,
         .help = "measures a few poses: is the arm still as it was accepted",
         .modes = kReady,
         .alone = true},
    Verb{.name = "pause", .handler = pause<true>, .help = "of identify"},
    Verb{.name = "resume", .handler = pause<false>, .help = "of identify; measures again"},
    Verb{.name = "send",
         .handler = send,
         .help = "part=N bytes=B hex=...: a signature from outside, for compare",
         .modes = kBetweenSequences,
         .alone = true,
         .takes = Verb::Takes::kKeys},
    Verb{.name = "compare",
         .handler = compare,
         .help = "measures the validation poses for a candidate that was sent",
         .modes = kReady,
         .alone = true,
         .referenced = true},
    Verb{.name = "candidate",
         .handler = tell_candidate,
         .help = "the candidate against the active model on validation poses",
         .only_asks = true},
    Verb{.name = "accept",
         .handler = accept,
         .help = "stores the candidate and servoes with it",
         .modes = kStanding,
         .alone = true,
         .referenced = true,
         .takes = hal::kSmallImage ? Verb::Takes::kNothing : Verb::Takes::kKeys},
    Verb{.name = "rollback",
         .handler = rollback,
         .help = "back to the signature before, or to the nominal model",
         .modes = kStanding,
         .alone = true},
    Verb{.name = "confirm",
         .handler = confirm,
         .help = "q1_deg=10 q3_mm=5: a person sees these joints there; they are referenced again",
         .modes = kStanding,
         .alone = true,
         .takes = Verb::Takes::kKeys},
    Verb{.name = "acknowledge",
         .handler = acknowledge,
         .help = "tool moves by the nominal model although a signature is stored"},
    Verb{.name = "signature",
         .handler = tell_signature,
         .help = "the parameters servoed with",
         .only_asks = true},
    Verb{.name = "touch-grid",
         .handler = touch_grid,
         .help = "sends the tool to every vertex of the taught grid",
         .modes = kReady,
         .alone = true,
         .referenced = true},
    Verb{.name = "log",
         .handler = tell_log,
         .help = "how much was measured; row=N tells one row",
         .only_asks = true,
         .takes = Verb::Takes::kKeys},
    Verb{.name = "fetch",
         .handler = fetch,
         .help = "what=signature, candidate or nominal, part=N: a record in parts",
         .only_asks = true,
         .takes = Verb::Takes::kKeys},
    Verb{.name = "help",
         .handler = help,
         .help = "the verbs; help VERB tells one of them",
         .only_asks = true,
         .takes = Verb::Takes::kVerb},
};

// The verbs, with that of homing where there is one.
constexpr auto kVerbs = [] {
  if constexpr (hal::kMayHome) {
    std::array<Verb, kVerbsOfAll.size() + 1> all;
    std::ranges::copy(kVerbsOfAll, all.begin());
    all.back() = kVerbsOfAll.back();
    all[kVerbsOfAll.size() - 1] = {
        .name = "home",
        .handler = home,
        .help = "joint=2: its drive finds its reference by itself, the others hold",
        .modes = modes_of(CommandKind::kHome),
        .alone = true,
        .takes = Verb::Takes::kKeys};
    return all;
  } else {
    return kVerbsOfAll;
  }
}();

}  // namespace

std::span<const Verb> verbs() { return kVerbs; }

void tell_modes(const Modes& modes, Line& out) {
  out.text(" modes=");
  bool first = true;
  for (const Mode mode : kAllModes) {
    if (!modes.contains(mode)) continue;
    out.text(first ? "" : ",").text(name(mode));
    first = false;
  }
}

const Verb* find_verb(std::string_view name) {
  const auto* found = std::ranges::find(kVerbs, name, &Verb::name);
  return found == kVerbs.end() ? nullptr : found;
}

IdentificationSequence::Conditions conditions_of(const Controls& controls) {
  const auto& machine = controls.custody.machine();
  return {.active = controls.custody.in_use(),
          .machine = machine ? &*machine : nullptr,
          .now_s = controls.clock.calendar_s()};
}

Result<Answer> when_stored(const Result<void>& begun) {
  if (!begun) return std::unexpected(begun.error());
  return Answer{Answer::When::kStored};
}

Result<Answer> when_taken(std::optional<Ticket> ticket) {
  if (!ticket) return std::unexpected(Error::kBusBusy);
  return Answer{Answer::When::kTaken, *ticket};
}

}  // namespace armsig::controller
