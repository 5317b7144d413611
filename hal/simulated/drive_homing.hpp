// SPDX-License-Identifier: MIT
// The homing mode of an emulated drive, by the device's side of CiA 402-2: fast to the switch and
// beyond it, slowly back to its edge, and rest.
#pragma once

#include <cstdint>
#include <optional>

#include "hal/simulated/drive_motion.hpp"

namespace armsig::simulated {

// What its objects say.
struct HomingObjects {
  std::int32_t offset = 0;  // 607Ch: what it counts at the edge
  std::int8_t method = 0;   // 6098h; 35 and 37: where it stands
  double fast = 0;          // 6099h:1, counts/s
  double slow = 0;          // 6099h:2
};

class DriveHoming {
 public:
  // Bit 4 of the controlword, in homing mode and with torque.
  void command(bool search, const HomingObjects& objects, DriveMotion& motion);
  // Once a step of the motion. `edge`: where its switch is, in counts; empty: it has none, and
  // gives up. The place that is found now, if one is.
  [[nodiscard]] std::optional<double> step(const HomingObjects& objects,
                                           const std::optional<double>& edge, DriveMotion& motion);
  // Bits 10, 12 and 13 of the statusword.
  [[nodiscard]] std::uint16_t status_bits(const DriveMotion& motion) const;
  void forget() { *this = {}; }

 private:
  enum class Stage : std::uint8_t { kIdle, kFast, kSlow, kFound, kFailed };

  Stage stage_ = Stage::kIdle;
  bool commanded_ = false;
  double reference_ = 0;
};

}  // namespace armsig::simulated
