// SPDX-License-Identifier: MIT
// A master's configuration for the six drives of a Puma-sized arm.
#pragma once

#include <chrono>
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

// Three joints a bus, at 1 kHz; the nodes of both buses are 1, 2 and 3.
inline void put_on_two_buses(canopen::Configuration& configuration) {
  configuration.period = std::chrono::milliseconds(1);
  configuration.buses.count = 2;
  for (std::uint8_t joint = 0; joint < 6; ++joint) {
    configuration.axes[joint].node = static_cast<std::uint8_t>(joint % 3 + 1);
    configuration.axes[joint].bus = joint / 3;
  }
}
inline canopen::Configuration puma_on_two_buses() {
  canopen::Configuration configuration = puma_drives();
  put_on_two_buses(configuration);
  return configuration;
}

}  // namespace armsig::test
