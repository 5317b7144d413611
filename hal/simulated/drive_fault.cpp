// SPDX-License-Identifier: MIT
#include "hal/simulated/drive_fault.hpp"

#include <array>
#include <utility>

namespace armsig::simulated {

std::optional<DriveFault> drive_fault(std::string_view name) {
  static constexpr std::array kNames{
      std::pair{std::string_view("none"), DriveFault::kNone},
      std::pair{std::string_view("emergency"), DriveFault::kEmergency},
      std::pair{std::string_view("silent"), DriveFault::kSilent},
      std::pair{std::string_view("heartbeat"), DriveFault::kHeartbeatLost},
      std::pair{std::string_view("feedback"), DriveFault::kFeedbackLost},
      std::pair{std::string_view("blocked"), DriveFault::kBlocked},
      std::pair{std::string_view("power"), DriveFault::kPowerRemoved},
      std::pair{std::string_view("reboot"), DriveFault::kReboot},
      std::pair{std::string_view("deaf"), DriveFault::kDeaf},
      std::pair{std::string_view("jump"), DriveFault::kPositionJump},
      std::pair{std::string_view("pre-operational"), DriveFault::kPreOperational},
      std::pair{std::string_view("sdo"), DriveFault::kSdoSilent},
      std::pair{std::string_view("sync"), DriveFault::kSyncLost},
      std::pair{std::string_view("ignores"), DriveFault::kIgnoresTargets},
      std::pair{std::string_view("bits-clear"), DriveFault::kBitsClear},
      std::pair{std::string_view("bits-set"), DriveFault::kBitsSet},
      std::pair{std::string_view("information"), DriveFault::kInformation},
  };
  for (const auto& [known, fault] : kNames) {
    if (known == name) return fault;
  }
  return std::nullopt;
}

}  // namespace armsig::simulated
