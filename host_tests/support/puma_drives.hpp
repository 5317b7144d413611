// SPDX-License-Identifier: MIT
// A master's configuration for the six drives of a Puma-sized arm.
#pragma once

#include <cstdint>

#include "core/base/pose.hpp"
#include "hal/canopen/configuration.hpp"

namespace armsig::test {

inline canopen::AxisConfiguration puma_axis(std::uint8_t node) {
  return {{.scaling = {.counts_per_revolution = 4000, .gear_ratio = 100},
           .limits = {radians(-170), radians(170)},
           .largest_speed = 2.0},
          node};
}

inline canopen::Configuration puma_drives(std::uint8_t axes = 6) {
  canopen::Configuration configuration;
  for (std::uint8_t node = 1; node <= axes; ++node) configuration.axes.push_back(puma_axis(node));
  return configuration;
}

// Two joints a node: its first axis, and its second.
inline canopen::Configuration puma_on_dual_drives(std::uint8_t axes = 6) {
  canopen::Configuration configuration = puma_drives(axes);
  for (std::uint8_t joint = 0; joint < axes; ++joint) {
    configuration.axes[joint].node = static_cast<std::uint8_t>(joint / 2 + 1);
    configuration.axes[joint].axis = static_cast<std::uint8_t>(joint % 2 + 1);
  }
  return configuration;
}

}  // namespace armsig::test
