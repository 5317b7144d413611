// SPDX-License-Identifier: MIT
// What a CANopen master must be told about the drives, checked as a whole before a frame is sent.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/error.hpp"
#include "core/base/fixed_vector.hpp"
#include "hal/canopen/bus_load.hpp"
#include "hal/canopen/buses.hpp"
#include "hal/canopen/protocol.hpp"
#include "hal/cia402/settings.hpp"

namespace armsig::canopen {

inline constexpr std::size_t kMaxOtherNodes = 4;
inline constexpr std::size_t kMaxOtherTraffic = 16;

// The identifier of PDO1 of an axis, by the function code of that of the first axis: axis n has
// what the predefined connection set keeps for PDO n of the node.
[[nodiscard]] constexpr std::uint32_t pdo1_id(std::uint32_t function, NodeId node,
                                              std::uint8_t axis) {
  return function + (cia402::kMostAxes > 1 ? kNextPdo * (axis - 1U) : 0) + node;
}

struct AxisConfiguration : cia402::DriveSettings {
  NodeId node = 0;
  [[no_unique_address]] BusNumber bus = 0;

  // Another axis of the same device.
  [[nodiscard]] constexpr bool shares_node(const AxisConfiguration& other) const {
    return cia402::kMostAxes > 1 && node == other.node && bus == other.bus;
  }
};

// What is on a bus beside the drives.
struct OtherDevices {
  // Devices that the master starts but does not drive, such as the range sensor.
  FixedVector<NodeId, kMaxOtherNodes> nodes;
  // What those devices and any others send, for the bus load.
  FixedVector<PeriodicFrame, kMaxOtherTraffic> traffic;
};

struct Configuration : cia402::GroupSettings {
  FixedVector<AxisConfiguration, kMaxJoints> axes;  // base to tip
  std::array<OtherDevices, kMostBuses> others;
  [[no_unique_address]] Buses buses;
  NodeId master_node = kLargestNode;
  std::uint32_t bits_per_second = 1'000'000;
  hal::Duration heartbeat = std::chrono::milliseconds(50);
  hal::Duration heartbeat_timeout = std::chrono::milliseconds(150);
  hal::Duration boot_timeout = std::chrono::seconds(2);
  hal::Duration sdo_timeout = std::chrono::milliseconds(100);
  unsigned sdo_attempts = 3;
  unsigned missed_feedback_limit = 2;  // SYNCs in a row that a drive may leave unanswered, less one
};

struct ConfigurationRefusal {
  Error error = Error::kNotFinite;
  std::optional<std::size_t> axis;  // from 0; empty where no single axis is to blame
  double found = 0;                 // SI units; for kBusOverload the part of the bus
  double needed = 0;                // the bound that was broken
  std::string_view reason = {};     // why it is one; may be empty
};

class CheckedConfiguration;

// Errors: kTooFewAxes (none),
// kUnsupported (a mode, an axis or a bus that the image does not have, or a write to an object that
// is not free),
// kNotFinite, kNodeOutOfRange, kNodeTwice (of one bus axes, other nodes and master together; two
// joints may be two axes of one node), kScaleInvalid,
// kResolutionTooCoarse, kLimitsReversed, kLimitsImplausible, kPositionOverflow (a limit or the
// following window), kPeriodInvalid (period, heartbeats, time-outs, retries or speed), kBusOverload
// (above kLargestBusLoad).
[[nodiscard]] std::expected<CheckedConfiguration, ConfigurationRefusal> check(
    const Configuration& configuration);

// A configuration that passed check(); there is no other way to get one, so that a master cannot
// send a frame on an unchecked one.
class CheckedConfiguration {
 public:
  [[nodiscard]] const Configuration& operator*() const { return configuration_; }
  [[nodiscard]] const Configuration* operator->() const { return &configuration_; }
  [[nodiscard]] const cia402::Scaling& scaling(std::size_t axis) const { return *scalings_[axis]; }
  [[nodiscard]] double bus_load(BusNumber bus = 0) const { return bus_loads_[bus]; }

 private:
  friend std::expected<CheckedConfiguration, ConfigurationRefusal> check(
      const Configuration& configuration);
  CheckedConfiguration() = default;

  Configuration configuration_;
  FixedVector<std::optional<cia402::Scaling>, kMaxJoints> scalings_;
  std::array<double, kMostBuses> bus_loads_{};
};

// Whether no joint before `axis` is another axis of the same node.
[[nodiscard]] inline bool is_first_of_node(const Configuration& configuration, std::size_t axis) {
  if constexpr (cia402::kMostAxes == 1) return true;
  for (std::size_t former = 0; former < axis; ++former) {
    if (configuration.axes[former].shares_node(configuration.axes[axis])) return false;
  }
  return true;
}

// The part of a bus that the periodic frames of `configuration` take at worst: SYNC, two PDOs an
// axis, heartbeats of all, other traffic. Expedited SDOs are not in it: they are few, come one at a
// time, and any PDO wins over them.
[[nodiscard]] double periodic_load(const Configuration& configuration, BusNumber bus = 0);

}  // namespace armsig::canopen
