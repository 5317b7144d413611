// SPDX-License-Identifier: MIT
// A Puma's cabinet whose drives have a switch to home at.
#pragma once

#include <array>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::test {

// The switch of joint 2 is 2 degrees from where the joint stands at power-up, -90. Every drive has
// one at as many counts.
inline constexpr std::int32_t kHomeSwitch = -97778;

inline constexpr std::array<simulated::ObjectEdit, 3> kHomingObjects{{
    {{0x607C, 0, 4, simulated::Access::kReadWrite, static_cast<std::uint32_t>(kHomeSwitch)}},
    {{0x6098, 0, 1, simulated::Access::kReadWrite, 17}},
    {{0x6099, 1, 4, simulated::Access::kReadWrite, 4000}},
}};

inline simulated::DriveConfiguration homing_puma_drive() {
  simulated::DriveConfiguration drive = honest_puma_drive();
  drive.counts_anew = true;
  drive.home_switch = kHomeSwitch;
  drive.edits = kHomingObjects;
  return drive;
}

// All but joint 1 are homed.
inline controller::Configuration homing_puma_controller() {
  using controller::Reference;
  controller::Configuration configuration = puma_controller();
  configuration.references = FixedVector<Reference, kMaxJoints>(6, Reference::kHomed);
  configuration.references[0] = Reference::kAbsolute;
  return configuration;
}

}  // namespace armsig::test
