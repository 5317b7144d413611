// SPDX-License-Identifier: MIT
// What the buses of a range sensor have in common in the configuration file, and the parts of
// `modbus`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/daemon_configuration.hpp"
#include "firmware/linux/settings.hpp"
#include "hal/freshness.hpp"
#include "hal/linux/rtu_range_sensor.hpp"

namespace armsig::daemon {

inline constexpr int kLargestRegister = 0xFFFF;  // of a Modbus unit

// Where in the frame of the last link `name` is, by the drawing.
[[nodiscard]] tool::Read<Vector3> read_target(const tool::YamlNode& node, const std::string& name);

// The keys x, y and z of a place, each with its unit; and the place, in a map that may have others.
[[nodiscard]] std::vector<std::string> point_keys();
[[nodiscard]] tool::Read<Vector3> read_point(const tool::YamlMap& map,
                                             const controller::Bounds& bounds);

// `facing`, where it is there. Refused: places, which `node` tells, that locate no target.
[[nodiscard]] tool::Read<void> finish_array(const tool::YamlMap& map, const tool::YamlNode& node,
                                            measurement::ReceiverArray& array);

// `path`: whether what is measured is there and back.
[[nodiscard]] tool::Read<void> read_path(const tool::YamlMap& map, bool& echo);

// `format`: of a number in registers.
[[nodiscard]] tool::Read<void> read_format(const tool::YamlMap& map, modbus::Format& format);

// `words`: of two registers.
[[nodiscard]] tool::Read<void> read_word_order(const tool::YamlMap& map, bool& high_word_first);

// `silent_after` and, of a sensor that `counts` its readings, `stale_after`: each lasts for two
// readings, one every `period`.
void read_freshness(Settings& settings, hal::Duration period, bool counts,
                    hal::FreshnessLimits& freshness);

// The same of the setting `name` that says how often there is a reading, which `period` is.
void bound_period(Settings& settings, std::string_view name, hal::Duration period,
                  const hal::FreshnessLimits& freshness);

// `stale_after` where nothing counts.
[[nodiscard]] tool::Read<void> refuse_stale(const tool::YamlMap& map, bool counts);

// `modbus` of a sensor.
[[nodiscard]] tool::Read<void> read_modbus(const tool::YamlNode& node, DaemonConfiguration& c);

// What `modbus` says of its channels, into `sensor`. Precondition: it has the key `channels`.
[[nodiscard]] tool::Read<void> read_channels(const tool::YamlMap& map,
                                             const controller::Sensor& array,
                                             linux_hal::RtuRangeSensorConfiguration& sensor);

}  // namespace armsig::daemon
