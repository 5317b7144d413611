// SPDX-License-Identifier: MIT
// What the controller is doing: Starting -> Idle -> Holding -> {Sweeping, Servoing, Homing} ->
// Holding, and Faulted from anywhere, left only by an explicit reset.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string_view>

namespace armsig::controller {

enum class Mode : std::uint8_t {
  kStarting,  // the drives are being found and set up
  kIdle,      // without torque
  kHolding,   // with torque, at rest
  kServoing,  // moving for the operator
  kSweeping,  // moving for a sequence, or waiting between two of its moves
  kHoming,    // one drive finds its reference, the others hold
  kFaulted,   // stopped; the error is kept until reset
};

[[nodiscard]] constexpr std::string_view name(Mode mode) {
  switch (mode) {
    case Mode::kStarting:
      return "starting";
    case Mode::kIdle:
      return "idle";
    case Mode::kHolding:
      return "holding";
    case Mode::kServoing:
      return "servoing";
    case Mode::kSweeping:
      return "sweeping";
    case Mode::kHoming:
      return "homing";
    case Mode::kFaulted:
      return "faulted";
  }
  return "unknown";
}

// Some of the modes.
class Modes {
 public:
  constexpr explicit Modes(std::same_as<Mode> auto... modes) : bits_((0U | ... | bit(modes))) {}

  [[nodiscard]] constexpr bool contains(Mode mode) const { return (bits_ & bit(mode)) != 0; }

 private:
  static constexpr unsigned bit(Mode mode) { return 1U << static_cast<unsigned>(mode); }

  unsigned bits_;
};

inline constexpr std::array kAllModes{Mode::kStarting, Mode::kIdle,     Mode::kHolding,
                                      Mode::kServoing, Mode::kSweeping, Mode::kHoming,
                                      Mode::kFaulted};
inline constexpr Modes kInAnyMode{Mode::kStarting, Mode::kIdle,   Mode::kHolding, Mode::kServoing,
                                  Mode::kSweeping, Mode::kHoming, Mode::kFaulted};
inline constexpr Modes kWithTorque{Mode::kHolding, Mode::kServoing, Mode::kSweeping, Mode::kHoming};

}  // namespace armsig::controller
