// SPDX-License-Identifier: MIT
// The larger sections of the configuration file, read in this order: each needs what is before it.
#pragma once

#include "firmware/formats/yaml_tree.hpp"
#include "firmware/linux/daemon_configuration.hpp"

namespace armsig::daemon {

// `joints`: drawing, drive and motion of each joint, base to tip.
[[nodiscard]] tool::Read<void> read_joints(const tool::YamlNode& list, DaemonConfiguration& c);

// `sensor`: its receivers, and the bus that it is on.
[[nodiscard]] tool::Read<void> read_sensor(const tool::YamlNode& node, DaemonConfiguration& c);

// `points` or `lengths`: the instrument that tells them.
[[nodiscard]] tool::Read<void> read_points(const tool::YamlNode& node, DaemonConfiguration& c);
[[nodiscard]] tool::Read<void> read_lengths(const tool::YamlNode& node, DaemonConfiguration& c);

// `virtual`: where the arm of `armsigd --virtual` stands.
[[nodiscard]] tool::Read<void> read_virtual(const tool::YamlNode& node, DaemonConfiguration& c);

// `touches`: the files of touches.
[[nodiscard]] tool::Read<void> read_touch_files(const tool::YamlNode& node, DaemonConfiguration& c);

// `grid`: the grid-touching task. Precondition: the limits have passed canopen::check().
[[nodiscard]] tool::Read<void> read_grid(const tool::YamlNode& node, DaemonConfiguration& c);

}  // namespace armsig::daemon
