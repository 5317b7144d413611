// SPDX-License-Identifier: MIT
#include "hal/canopen/configuration.hpp"

#include <array>
#include <chrono>
#include <cmath>

#include "core/base/pose.hpp"
#include "hal/cia402/setup.hpp"

namespace armsig::canopen {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Ten turns and twenty metres: beyond any joint, and below what a limit in degrees or millimetres
// that was taken for radians or metres usually is.
constexpr double kLargestLimit_rad = 20 * kPi;
constexpr double kLargestLimit_m = 20;

constexpr std::array<std::uint32_t, 5> kBitRates{1'000'000, 800'000, 500'000, 250'000, 125'000};

using Checked = std::expected<void, ConfigurationRefusal>;

constexpr std::uint8_t kWhole = 0xFF;  // of a node: all its axes, a bit each

// An image that knows one axis takes the whole node.
std::uint8_t part_of(const AxisConfiguration& axis) {
  if constexpr (cia402::kMostAxes == 1) return kWhole;
  return static_cast<std::uint8_t>(1U << (axis.axis - 1U));
}

Checked check_nodes(const Configuration& configuration, BusNumber bus) {
  std::array<std::uint8_t, kLargestNode + 1> taken{};  // a bit an axis
  const auto take = [&](NodeId node, std::optional<std::size_t> axis,
                        std::uint8_t part = kWhole) -> Checked {
    if (node == 0 || node > kLargestNode) {
      return std::unexpected(ConfigurationRefusal{Error::kNodeOutOfRange, axis,
                                                  static_cast<double>(node), kLargestNode});
    }
    if ((taken[node] & part) != 0) {
      return std::unexpected(
          ConfigurationRefusal{Error::kNodeTwice, axis, static_cast<double>(node), 0});
    }
    taken[node] |= part;
    return {};
  };
  if (auto ok = take(configuration.master_node, std::nullopt); !ok) return ok;
  for (std::size_t number = 0; number < configuration.axes.size(); ++number) {
    const AxisConfiguration& axis = configuration.axes[number];
    if (kMostBuses > 1 && axis.bus != bus) continue;
    if (auto ok = take(axis.node, number, part_of(axis)); !ok) return ok;
  }
  for (const NodeId node : configuration.others[bus].nodes) {
    if (auto ok = take(node, std::nullopt); !ok) return ok;
  }
  return {};
}

// There are as many buses as can be, and each joint is on one of them.
Checked check_buses(const Configuration& configuration) {
  const Buses& buses = configuration.buses;
  if (buses.count == 0 || buses.count > kMostBuses || buses.sink >= buses.count) {
    return std::unexpected(ConfigurationRefusal{Error::kUnsupported, std::nullopt,
                                                static_cast<double>(buses.count), kMostBuses});
  }
  for (std::size_t axis = 0; axis < configuration.axes.size(); ++axis) {
    const std::uint8_t bus = configuration.axes[axis].bus;
    if (bus < buses.count) continue;
    return std::unexpected(ConfigurationRefusal{Error::kUnsupported, axis, static_cast<double>(bus),
                                                static_cast<double>(buses.count)});
  }
  return {};
}

// Which axis of its node each joint is.
Checked check_axis_numbers(const Configuration& configuration) {
  for (std::size_t axis = 0; axis < configuration.axes.size(); ++axis) {
    const std::uint8_t number = configuration.axes[axis].axis;
    if (number >= 1 && number <= cia402::kMostAxes) continue;
    return std::unexpected(ConfigurationRefusal{Error::kUnsupported, axis,
                                                static_cast<double>(number), cia402::kMostAxes});
  }
  return {};
}

Checked check_axis(const AxisConfiguration& axis, std::size_t number,
                   const cia402::Scaling& scaling) {
  const auto refuse = [&](Error error, double found, double needed) -> Checked {
    return std::unexpected(ConfigurationRefusal{error, number, found, needed});
  };
  for (const double value : {axis.limits.lower, axis.limits.upper, axis.largest_speed,
                             axis.following_window, axis.stop_deceleration}) {
    if (!std::isfinite(value)) return refuse(Error::kNotFinite, value, 0);
  }
  if (axis.limits.lower >= axis.limits.upper) {
    return refuse(Error::kLimitsReversed, axis.limits.lower, axis.limits.upper);
  }
  const double largest =
      axis.scaling.type == JointType::kRevolute ? kLargestLimit_rad : kLargestLimit_m;
  for (const double limit : {axis.limits.lower, axis.limits.upper}) {
    if (std::fabs(limit) > largest) return refuse(Error::kLimitsImplausible, limit, largest);
    if (auto counts = scaling.counts(limit); !counts) return refuse(counts.error(), limit, 0);
  }
  if (axis.mode != axis.position_mode()) {
    return refuse(Error::kUnsupported, static_cast<double>(axis.mode),
                  static_cast<double>(axis.position_mode()));
  }
  for (const cia402::ObjectRequest& further : axis.further_writes()) {
    const bool sized = further.bytes == 1 || further.bytes == 2 || further.bytes == 4;
    if (!sized || !cia402::may_be_written(further.index)) {
      return refuse(Error::kUnsupported, further.index, 0);
    }
  }
  if (axis.largest_speed <= 0) return refuse(Error::kPeriodInvalid, axis.largest_speed, 0);
  if (axis.following_window < 0) return refuse(Error::kPeriodInvalid, axis.following_window, 0);
  if (axis.stop_deceleration < 0) return refuse(Error::kPeriodInvalid, axis.stop_deceleration, 0);
  if (auto ramp = scaling.distance_counts(axis.stop_deceleration); !ramp) {
    return refuse(ramp.error(), axis.stop_deceleration, 0);
  }
  if (auto window = scaling.distance_counts(axis.following_window); !window) {
    return refuse(window.error(), axis.following_window, 0);
  }
  return {};
}

// 1017h and the lower half of 1016h are 16-bit milliseconds.
bool is_heartbeat_time(hal::Duration time) {
  return time >= milliseconds(1) && time <= milliseconds(65535) &&
         time % milliseconds(1) == hal::Duration::zero();
}

// The longest that anything may be waited for: longer is a slip of unit, and an arm that nobody
// stops meanwhile.
Checked check_patience(const Configuration& c) {
  struct Wait {
    hal::Duration time;
    hal::Duration shortest;
    hal::Duration longest;
    std::string_view reason;
  };
  const cia402::StatusLimits& status = c.status_limits;
  const hal::Duration unheard = c.period * static_cast<int>(c.missed_feedback_limit);
  for (const Wait& wait : {
           Wait{c.heartbeat, c.period, seconds(10), "a tick sends one heartbeat at most"},
           Wait{c.heartbeat_timeout, c.period, seconds(15),
                "a drive that is gone is believed for as long"},
           Wait{c.boot_timeout, c.period, seconds(120), "no drive takes longer to start"},
           Wait{c.sdo_timeout, c.period, seconds(10), "no drive takes longer to answer"},
           Wait{c.transition_timeout, c.period, seconds(60), "no brake takes longer to open"},
           Wait{unheard, c.period, seconds(15), "a joint moves unseen for as many ticks"},
           Wait{c.stop_timeout, c.period, seconds(60),
                "a joint that can't be stopped keeps its torque for as long"},
           Wait{c.homing_timeout, c.period, seconds(600), "a drive searches for as long"},
           Wait{status.ignores, c.period, seconds(30), "a drive ignores its targets for as long"},
           Wait{status.limits, c.period, seconds(60), "a drive limits the motion for as long"},
           Wait{status.lags, c.period, seconds(30), "a drive lags behind for as long"},
           Wait{status.warns, c.period, seconds(600), "a warning is passed over for as long"},
           Wait{status.no_voltage, c.period, seconds(30), "a drive has no voltage for as long"},
       }) {
    if (wait.time >= wait.shortest && wait.time <= wait.longest) continue;
    const hal::Duration bound = wait.time < wait.shortest ? wait.shortest : wait.longest;
    return std::unexpected(ConfigurationRefusal{Error::kPeriodInvalid, std::nullopt,
                                                hal::seconds(wait.time), hal::seconds(bound),
                                                wait.reason});
  }
  return {};
}

Checked check_times(const Configuration& configuration) {
  const auto refuse = [](double found, double needed) -> Checked {
    return std::unexpected(
        ConfigurationRefusal{Error::kPeriodInvalid, std::nullopt, found, needed});
  };
  if (!cia402::interpolation_period(configuration.period))
    return refuse(hal::seconds(configuration.period), 0);
  for (const hal::Duration time : {configuration.heartbeat, configuration.heartbeat_timeout}) {
    if (!is_heartbeat_time(time)) return refuse(hal::seconds(time), 1e-3);
  }
  if (configuration.heartbeat_timeout <= configuration.heartbeat) {
    return refuse(hal::seconds(configuration.heartbeat_timeout),
                  hal::seconds(configuration.heartbeat));
  }
  if (auto ok = check_patience(configuration); !ok) return ok;
  for (const unsigned count : {configuration.sdo_attempts, configuration.missed_feedback_limit}) {
    if (count == 0) return refuse(0, 1);
  }
  for (const OtherDevices& others : configuration.others) {
    for (const PeriodicFrame& frame : others.traffic) {
      if (frame.period <= hal::Duration::zero() || frame.data_bytes > hal::kMaxCanData) {
        return refuse(hal::seconds(frame.period), 0);
      }
    }
  }
  for (const std::uint32_t rate : kBitRates) {
    if (rate == configuration.bits_per_second) return {};
  }
  return refuse(configuration.bits_per_second, kBitRates[0]);
}

// A stop from the largest speed must end before the torque goes.
Checked check_ramps(const Configuration& configuration) {
  for (std::size_t axis = 0; axis < configuration.axes.size(); ++axis) {
    const double deceleration = configuration.axes[axis].stop_deceleration;
    if (deceleration == 0) continue;
    const double needed =
        configuration.axes[axis].largest_speed / hal::seconds(configuration.stop_timeout);
    if (deceleration < needed) {
      return std::unexpected(
          ConfigurationRefusal{Error::kPeriodInvalid, axis, deceleration, needed});
    }
  }
  return {};
}

}  // namespace

std::expected<CheckedConfiguration, ConfigurationRefusal> check(
    const Configuration& configuration) {
  CheckedConfiguration checked;
  checked.configuration_ = configuration;
  if (configuration.axes.empty()) {
    return std::unexpected(ConfigurationRefusal{Error::kTooFewAxes, std::nullopt, 0, 1});
  }
  if constexpr (cia402::kMostAxes > 1) {
    if (auto ok = check_axis_numbers(configuration); !ok) return std::unexpected(ok.error());
  }
  if constexpr (kMostBuses > 1) {
    if (auto ok = check_buses(configuration); !ok) return std::unexpected(ok.error());
  }
  for (std::uint8_t bus = 0; bus < configuration.buses.count; ++bus) {
    if (auto ok = check_nodes(configuration, bus); !ok) return std::unexpected(ok.error());
  }
  for (std::size_t axis = 0; axis < configuration.axes.size(); ++axis) {
    const cia402::ScalingConfiguration& scale = configuration.axes[axis].scaling;
    const auto scaling = cia402::Scaling::make(scale);
    if (!scaling) {
      return std::unexpected(ConfigurationRefusal{
          scaling.error(), axis, scale.counts_per_revolution * scale.gear_ratio, 0});
    }
    checked.scalings_.push_back(*scaling);
    if (auto ok = check_axis(configuration.axes[axis], axis, *scaling); !ok) {
      return std::unexpected(ok.error());
    }
  }
  if (auto ok = check_times(configuration); !ok) return std::unexpected(ok.error());
  if (auto ok = check_ramps(configuration); !ok) return std::unexpected(ok.error());
  for (std::uint8_t bus = 0; bus < configuration.buses.count; ++bus) {
    const double load = checked.bus_loads_[bus] = periodic_load(configuration, bus);
    if (load > kLargestBusLoad) {
      return std::unexpected(
          ConfigurationRefusal{Error::kBusOverload, std::nullopt, load, kLargestBusLoad});
    }
  }
  return checked;
}

double periodic_load(const Configuration& configuration, BusNumber bus) {
  FixedVector<PeriodicFrame, 2 + 3 * kMaxJoints + kMaxOtherNodes + kMaxOtherTraffic> frames;
  frames.push_back({0, configuration.period});     // SYNC
  frames.push_back({1, configuration.heartbeat});  // of the master
  for (std::size_t axis = 0; axis < configuration.axes.size(); ++axis) {
    if (kMostBuses > 1 && configuration.axes[axis].bus != bus) continue;
    frames.push_back({kDrivePdoBytes, configuration.period});  // RPDO1
    const bool has_torque = configuration.axes[axis].tells_torque();
    const auto told = static_cast<std::uint8_t>(kDrivePdoBytes + (has_torque ? kTorqueBytes : 0));
    frames.push_back({told, configuration.period});  // TPDO1
    if (is_first_of_node(configuration, axis)) frames.push_back({1, configuration.heartbeat});
  }
  const OtherDevices& others = configuration.others[bus];
  for (std::size_t i = 0; i < others.nodes.size(); ++i) {
    frames.push_back({1, configuration.heartbeat});
  }
  for (const PeriodicFrame& frame : others.traffic) frames.push_back(frame);
  return bus_load({frames.data(), frames.size()}, configuration.bits_per_second);
}

}  // namespace armsig::canopen
