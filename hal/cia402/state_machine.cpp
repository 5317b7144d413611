// SPDX-License-Identifier: MIT
#include "hal/cia402/state_machine.hpp"

#include <algorithm>
#include <array>
#include <iterator>

#include "core/base/check.hpp"

namespace armsig::cia402 {
namespace {

// CiA 402-2, table of statusword codings: state if (word & mask) == pattern.
struct Coding {
  std::uint16_t mask;
  std::uint16_t pattern;
  State state;
};
constexpr std::array<Coding, 8> kCodings{{
    {0x4F, 0x00, State::kNotReadyToSwitchOn},
    {0x4F, 0x40, State::kSwitchOnDisabled},
    {0x6F, 0x21, State::kReadyToSwitchOn},
    {0x6F, 0x23, State::kSwitchedOn},
    {0x6F, 0x27, State::kOperationEnabled},
    {0x6F, 0x07, State::kQuickStopActive},
    {0x4F, 0x0F, State::kFaultReactionActive},
    {0x4F, 0x08, State::kFault},
}};

// The way to each goal, a transition a state; a state that is not listed is left alone. Transition
// 16 is not used: the standard makes it optional, and an operator who enables again after a quick
// stop is served by 12, 2, 3, 4 on every drive.
struct Route {
  Goal goal;
  State from;
  std::uint8_t transition;
};
constexpr std::array<Route, 11> kRoutes{{
    {Goal::kEnabled, State::kSwitchOnDisabled, 2},
    {Goal::kEnabled, State::kReadyToSwitchOn, 3},
    {Goal::kEnabled, State::kSwitchedOn, 4},
    {Goal::kEnabled, State::kQuickStopActive, 12},
    {Goal::kDisabled, State::kOperationEnabled, 5},
    {Goal::kDisabled, State::kSwitchedOn, 6},
    {Goal::kDisabled, State::kReadyToSwitchOn, 7},
    {Goal::kDisabled, State::kQuickStopActive, 12},
    {Goal::kStopped, State::kOperationEnabled, 11},
    {Goal::kStopped, State::kSwitchedOn, 10},
    {Goal::kStopped, State::kReadyToSwitchOn, 7},
}};

}  // namespace

std::string_view describe(State state) {
  switch (state) {
    case State::kNotReadyToSwitchOn:
      return "Not ready to switch on";
    case State::kSwitchOnDisabled:
      return "Switch on disabled";
    case State::kReadyToSwitchOn:
      return "Ready to switch on";
    case State::kSwitchedOn:
      return "Switched on";
    case State::kOperationEnabled:
      return "Operation enabled";
    case State::kQuickStopActive:
      return "Quick stop active";
    case State::kFaultReactionActive:
      return "Fault reaction active";
    case State::kFault:
      return "Fault";
  }
  return "unknown state";
}

State decode_state(std::uint16_t status_word) {
  for (const Coding& coding : kCodings) {
    if ((status_word & coding.mask) == coding.pattern) return coding.state;
  }
  return State::kNotReadyToSwitchOn;
}

bool reached(Goal goal, State state) {
  switch (goal) {
    case Goal::kDisabled:
      return state == State::kSwitchOnDisabled;
    case Goal::kEnabled:
      return state == State::kOperationEnabled;
    case Goal::kStopped:
      return state == State::kQuickStopActive || state == State::kSwitchOnDisabled;
  }
  return false;
}

Step next_step(Goal goal, State state, bool stands) {
  if (!stands && state == State::kQuickStopActive) return {0, Command::kQuickStop};
  if (!stands && goal == Goal::kDisabled && state == State::kOperationEnabled) {
    goal = Goal::kStopped;
  }
  if (reached(goal, state)) {
    if (state == State::kOperationEnabled) return {0, Command::kEnableOperation};
    if (state == State::kQuickStopActive) return {0, Command::kQuickStop};
    return {};
  }
  for (const Route& route : kRoutes) {
    if (route.goal != goal || route.from != state) continue;
    const auto* transition = std::ranges::find(kTransitions, route.transition, &Transition::number);
    ARMSIG_CHECK(transition != std::end(kTransitions) && transition->from == state);
    return {transition->number, transition->command};
  }
  return {};
}

}  // namespace armsig::cia402
