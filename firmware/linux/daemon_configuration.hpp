// SPDX-License-Identifier: MIT
// The one file that armsigd is configured by (docs/controller.md; firmware/linux/reference.yaml is
// a commented example), checked as a whole before a frame is sent or anything moves.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/length_points.hpp"
#include "firmware/formats/mounting.hpp"
#include "firmware/formats/problem.hpp"
#include "firmware/linux/touch_file.hpp"
#include "firmware/virtual_cabinet/hand_leading.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/range_sensor.hpp"
#include "hal/linux/line_server.hpp"
#include "hal/linux/register_client.hpp"
#include "hal/linux/rtu_range_sensor.hpp"

namespace armsig::daemon {

inline constexpr std::string_view kConfigurationTag = "controller/1";

struct DaemonConfiguration {
  std::string name;
  controller::Configuration controller;
  canopen::Configuration drives;
  std::vector<std::string> can_interfaces;  // one or two
  // What measures; std::monostate: nothing does.
  std::variant<linux_hal::RtuRangeSensorConfiguration, canopen::RangeNodeConfiguration,
               linux_hal::LineServerConfiguration, linux_hal::RegisterClientConfiguration,
               std::monostate>
      sensor;
  controller::LengthOffsets length_offsets_m;  // of an instrument of lengths, else empty
  Vector3 p_nT = Vector3::Zero();  // the target in the frame of the last link, by the drawing
  std::string console;             // path of the Unix socket
  std::string reporting_console;   // path of one that answers what changes nothing; empty: none
  std::string store;               // path of the file that keeps the signatures
  std::string black_box;           // folder of its files; empty: black-box beside the store
  TouchFiles touches;
  int priority = 80;  // of the servo thread, SCHED_FIFO; 0: ordinary scheduling
  // Of a virtual controller: frame 0 of the arm in the sensor frame; none: by the arm's reach.
  std::optional<Pose> virtual_base;
  cabinet::EmulatedSockets virtual_sockets;  // of a virtual controller, into which it is led
  tool::LengthWords lengths;                 // in what the file tells `workspace`
  std::vector<double> bus_loads;             // of each CAN bus at worst, 1 being all of it
};

// "can0", or "can0 and can1".
[[nodiscard]] inline std::string interfaces_in_words(const DaemonConfiguration& configuration) {
  const auto& names = configuration.can_interfaces;
  return names.size() > 1 ? names[0] + " and " + names[1] : names[0];
}

// Reads and checks everything that can be wrong in a configuration: units, unknown keys, values,
// and what the values say together. The problem names file, line and column.
[[nodiscard]] tool::Read<DaemonConfiguration> read_configuration(const std::string& path);
[[nodiscard]] tool::Read<DaemonConfiguration> parse_configuration(std::string_view text,
                                                                  std::string_view file);

}  // namespace armsig::daemon
