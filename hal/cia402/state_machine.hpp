// SPDX-License-Identifier: MIT
// The power drive system's state machine of CiA 402-2 (IEC 61800-7-201): states, transitions with
// the standard's numbers, and which transition leads towards a goal.
#pragma once

#include <cstdint>
#include <string_view>

namespace armsig::cia402 {

enum class State : std::uint8_t {
  kNotReadyToSwitchOn,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

[[nodiscard]] std::string_view describe(State state);

// Whether the motor has torque in `state`.
[[nodiscard]] constexpr bool has_torque(State state) {
  return state == State::kOperationEnabled || state == State::kQuickStopActive ||
         state == State::kFaultReactionActive;
}

// Bits of the statusword 6041h. Bits 12 and 13 have the first meanings in cyclic synchronous
// position mode, the others in homing and profile position mode; of interpolated position bit 12
// has the first and bit 13 none. Bit 10 tells in Quick stop active that the drive is at rest.
inline constexpr std::uint16_t kStatusVoltage = 1U << 4;
inline constexpr std::uint16_t kStatusTargetReached = 1U << 10;
inline constexpr std::uint16_t kStatusWarning = 1U << 7;
inline constexpr std::uint16_t kStatusInternalLimit = 1U << 11;
inline constexpr std::uint16_t kStatusFollowsTarget = 1U << 12;
inline constexpr std::uint16_t kStatusFollowingError = 1U << 13;
inline constexpr std::uint16_t kStatusHomingAttained = 1U << 12;
inline constexpr std::uint16_t kStatusHomingError = 1U << 13;
inline constexpr std::uint16_t kStatusTargetTaken = 1U << 12;  // of profile position

// Bits of the controlword 6040h by mode. Homing: the search goes on while it is set. Interpolated
// position: the positions are followed. Profile position: its rising edge offers a target, which is
// gone for at once, in the place of the former one.
inline constexpr std::uint16_t kControlHomingStart = 1U << 4;
inline constexpr std::uint16_t kControlInterpolate = 1U << 4;
inline constexpr std::uint16_t kControlNewTarget = 1U << 4;
inline constexpr std::uint16_t kControlAtOnce = 1U << 5;

// The state that a statusword tells. A word that the standard leaves undefined counts as
// kNotReadyToSwitchOn, from which nothing is commanded.
[[nodiscard]] State decode_state(std::uint16_t status_word);

// Commands of the controlword 6040h, by their bit patterns with every optional bit 0.
enum class Command : std::uint8_t {
  kDisableVoltage = 0x00,
  kQuickStop = 0x02,
  kShutdown = 0x06,
  kSwitchOn = 0x07,  // the same pattern is "disable operation" in Operation enabled
  kEnableOperation = 0x0F,
  kFaultReset = 0x80,  // acts on the rising edge of its bit
};

// One commanded transition. Those the drive makes by itself (0, 1, 13, 14) are not listed.
struct Transition {
  std::uint8_t number;  // as in the standard's figure
  State from;
  State to;
  Command command;
};

// Every commanded transition, in the order of the standard's numbers.
inline constexpr Transition kTransitions[] = {
    {2, State::kSwitchOnDisabled, State::kReadyToSwitchOn, Command::kShutdown},
    {3, State::kReadyToSwitchOn, State::kSwitchedOn, Command::kSwitchOn},
    {4, State::kSwitchedOn, State::kOperationEnabled, Command::kEnableOperation},
    {5, State::kOperationEnabled, State::kSwitchedOn, Command::kSwitchOn},
    {6, State::kSwitchedOn, State::kReadyToSwitchOn, Command::kShutdown},
    {7, State::kReadyToSwitchOn, State::kSwitchOnDisabled, Command::kDisableVoltage},
    {8, State::kOperationEnabled, State::kReadyToSwitchOn, Command::kShutdown},
    {9, State::kOperationEnabled, State::kSwitchOnDisabled, Command::kDisableVoltage},
    {10, State::kSwitchedOn, State::kSwitchOnDisabled, Command::kDisableVoltage},
    {11, State::kOperationEnabled, State::kQuickStopActive, Command::kQuickStop},
    {12, State::kQuickStopActive, State::kSwitchOnDisabled, Command::kDisableVoltage},
    {15, State::kFault, State::kSwitchOnDisabled, Command::kFaultReset},
    {16, State::kQuickStopActive, State::kOperationEnabled, Command::kEnableOperation},
};

// Where the drives are wanted.
enum class Goal : std::uint8_t {
  kDisabled,  // Switch on disabled, by way of the ramp of transition 5
  kEnabled,   // Operation enabled
  kStopped,   // Quick stop active, or without torque if there was none
};

// Whether a drive in `state` rests where `goal` wants it.
[[nodiscard]] bool reached(Goal goal, State state);

struct Step {
  std::uint8_t transition = 0;  // the standard's number, 0 where nothing is commanded
  Command command = Command::kDisableVoltage;
};

// What to command a drive in `state` towards `goal`. At the goal it is the command that holds the
// state. In kNotReadyToSwitchOn, kFaultReactionActive and kFault it is "disable voltage" without a
// transition: those end by themselves, or by a fault reset that must be asked for.
// While the joint does not stand (`stands` false) no command takes the torque off: an enabled drive
// that is wanted without torque is stopped first, and held in Quick stop active.
[[nodiscard]] Step next_step(Goal goal, State state, bool stands = true);

// The controlword: the command alone, every mode-specific bit 0 as CSP wants it.
[[nodiscard]] constexpr std::uint16_t control_word(Command command) {
  return static_cast<std::uint16_t>(command);
}

}  // namespace armsig::cia402
