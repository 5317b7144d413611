// SPDX-License-Identifier: MIT
// What the controller is doing: Starting -> Idle -> Holding -> {Sweeping, Servoing} -> Holding, and
// Faulted from anywhere, left only by an explicit reset.
#pragma once

#include <cstdint>
#include <string_view>

namespace armsig::controller {

enum class Mode : std::uint8_t {
  kStarting,  // the drives are being found and set up
  kIdle,      // without torque
  kHolding,   // with torque, at rest
  kServoing,  // moving for the operator
  kSweeping,  // moving for a sequence, or waiting between two of its moves
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
    case Mode::kFaulted:
      return "faulted";
  }
  return "unknown";
}

}  // namespace armsig::controller
