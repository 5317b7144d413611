// SPDX-License-Identifier: MIT
// What the configuration file says of the drive of one joint, and the units of a joint's motion.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/yaml_map.hpp"
#include "hal/canopen/configuration.hpp"

namespace armsig::daemon {

[[nodiscard]] constexpr tool::Dimension speed_of(JointType type) {
  return type == JointType::kRevolute ? tool::Dimension::kAngularSpeed : tool::Dimension::kSpeed;
}
[[nodiscard]] constexpr tool::Dimension acceleration_of(JointType type) {
  return type == JointType::kRevolute ? tool::Dimension::kAngularAcceleration
                                      : tool::Dimension::kAcceleration;
}

// A quantity that the joint must have, in the units of its type, above zero; in SI.
[[nodiscard]] tool::Read<double> positive(const tool::YamlMap& map, std::string_view name,
                                          tool::Dimension dimension);

// Node, counts, mode, what is known of it, and what is written besides. Limits, speed and homing
// are left to the caller.
[[nodiscard]] tool::Read<canopen::AxisConfiguration> read_drive(const tool::YamlMap& map,
                                                                JointType type);

// `interface` of a drive or of a sensor: which of `interfaces` it is on, by default the first.
[[nodiscard]] tool::Read<std::uint8_t> read_bus(const tool::YamlMap& map,
                                                const std::vector<std::string>& interfaces);

}  // namespace armsig::daemon
