// SPDX-License-Identifier: MIT
#include "hal/canopen/drive_setup.hpp"

#include <algorithm>
#include <chrono>

#include "hal/canopen/identity.hpp"
#include "hal/cia402/factors.hpp"

namespace armsig::canopen {
namespace {

using cia402::kHeartbeatConsumer;
using cia402::kHeartbeatProducer;
using cia402::kReceivePdoParameter;
using cia402::Setup;
using cia402::SetupRule;

// Objects of CiA 301.
constexpr std::uint16_t kCommunicationPeriod = 0x1006;
constexpr std::uint16_t kReceivePdoMapping = 0x1600;
constexpr std::uint16_t kTransmitPdoParameter = 0x1800;
constexpr std::uint16_t kTransmitPdoMapping = 0x1A00;

constexpr std::uint32_t kOnEverySync = 1;
constexpr std::uint32_t kLongestLife = 255;  // guard times
constexpr std::uint32_t kControlWordEntry = 0x60400010;
constexpr std::uint32_t kTargetPositionEntry = 0x607A0020;
constexpr std::uint32_t kInterpolationDataEntry = 0x60C10120;
constexpr std::uint32_t kStatusWordEntry = 0x60410010;
constexpr std::uint32_t kActualPositionEntry = 0x60640020;
constexpr std::uint32_t kActualTorqueEntry = 0x60770010;
constexpr std::uint32_t kNoEntry = 0;

constexpr unsigned kEntryIndex = 16;     // in an entry, from this bit on
constexpr std::uint16_t kOtherPdos = 3;  // PDO2 to PDO4, which may be on after power-up

struct Pdo {
  std::uint16_t parameter;
  std::uint16_t mapping;
  std::uint32_t id;
  std::uint32_t flags;
  std::uint32_t first_entry;
  std::uint32_t second_entry;
  std::uint32_t third_entry = kNoEntry;
};

void map(Setup& setup, const Pdo& pdo) {
  cia402::write(setup, pdo.parameter, 1, 4, kPdoOff | pdo.flags | pdo.id);
  cia402::write(setup, pdo.parameter, 2, 1, kOnEverySync);
  cia402::write(setup, pdo.mapping, 0, 1, 0);
  cia402::write(setup, pdo.mapping, 1, 4, pdo.first_entry);
  cia402::write(setup, pdo.mapping, 2, 4, pdo.second_entry);
  const bool has_third = hal::kTellsTorque && pdo.third_entry != kNoEntry;
  if (has_third) cia402::write(setup, pdo.mapping, 3, 4, pdo.third_entry);
  cia402::write(setup, pdo.mapping, 0, 1, has_third ? 3 : 2);
  cia402::write(setup, pdo.parameter, 1, 4, pdo.flags | pdo.id);
}

std::uint32_t milliseconds_of(hal::Duration time) {
  return static_cast<std::uint32_t>(time / std::chrono::milliseconds(1));
}

// The drive watches its master: by its heartbeat, else by what commands it, else by being guarded
// (life time: at least the heartbeat's time-out). It is watched by its own heartbeat, unless it is
// guarded. And it knows how long a cycle is. What an axis before it has set of the node is read,
// and left.
void append_supervision(Setup& setup, const Configuration& configuration, bool first_of_node) {
  const std::uint32_t timeout_ms = milliseconds_of(configuration.heartbeat_timeout);
  const std::uint32_t master = static_cast<std::uint32_t>(configuration.master_node) << 16;
  const auto period_us =
      static_cast<std::uint32_t>(configuration.period / std::chrono::microseconds(1));
  cia402::prefer(setup, {kHeartbeatConsumer, 1, 4, master | timeout_ms}, cia402::kAnyValue);
  cia402::prefer(setup, {kReceivePdoParameter, 5, 2, timeout_ms}, cia402::kAnyValue,
                 SetupRule::kInstead);
  const auto life = static_cast<std::uint32_t>(
      (configuration.heartbeat_timeout - hal::Duration(1)) / configuration.heartbeat + 1);
  cia402::prefer(setup, {cia402::kGuardTime, 0, 2, milliseconds_of(configuration.heartbeat)},
                 cia402::kAnyValue, SetupRule::kInstead);
  cia402::prefer(setup, {cia402::kLifeFactor, 0, 1, std::min(life, kLongestLife)},
                 cia402::kAnyValue, SetupRule::kInstead);
  cia402::write(setup, kHeartbeatProducer, 0, 2, milliseconds_of(configuration.heartbeat),
                first_of_node ? SetupRule::kMust : SetupRule::kSetting);
  cia402::prefer(setup, {kCommunicationPeriod, 0, 4, period_us}, cia402::kAnyValue);
}

// PDO2 to PDO4 of an axis.
void turn_off_other_pdos(Setup& setup, NodeId node) {
  for (std::uint16_t pdo = 1; pdo <= kOtherPdos; ++pdo) {
    const std::uint32_t step = kNextPdo * pdo + node;
    cia402::write(setup, static_cast<std::uint16_t>(kReceivePdoParameter + pdo), 1, 4,
                  kPdoOff | (kReceivePdo1Id + step), SetupRule::kIfPresent);
    cia402::write(setup, static_cast<std::uint16_t>(kTransmitPdoParameter + pdo), 1, 4,
                  kPdoOff | kNoRemote | (kTransmitPdo1Id + step), SetupRule::kIfPresent);
  }
}

void map_pdo1(Setup& setup, const AxisConfiguration& joint) {
  const auto entry = [&](std::uint32_t of_first_axis) {
    const std::uint32_t further =
        cia402::kMostAxes > 1 ? (joint.axis - 1U) * cia402::kProfileObjects : 0;
    return of_first_axis + (further << kEntryIndex);
  };
  const bool interpolates = joint.position_mode() == cia402::PositionMode::kInterpolated;
  map(setup, {kReceivePdoParameter, kReceivePdoMapping,
              pdo1_id(kReceivePdo1Id, joint.node, joint.axis), 0, entry(kControlWordEntry),
              entry(interpolates ? kInterpolationDataEntry : kTargetPositionEntry)});
  map(setup,
      {kTransmitPdoParameter, kTransmitPdoMapping, pdo1_id(kTransmitPdo1Id, joint.node, joint.axis),
       kNoRemote, entry(kStatusWordEntry), entry(kActualPositionEntry),
       joint.tells_torque() ? entry(kActualTorqueEntry) : kNoEntry});
}

}  // namespace

Setup drive_setup(const CheckedConfiguration& configuration, std::size_t axis) {
  const AxisConfiguration& joint = configuration->axes[axis];
  Setup setup;
  cia402::append_profile_check(setup, joint);
  append_identity_requests(setup);
  cia402::append_factor_requests(setup);
  append_supervision(setup, *configuration, is_first_of_node(*configuration, axis));
  std::size_t first = 0;
  if (cia402::kMostAxes > 1 && joint.axis > 1) {
    cia402::move_to_axis(setup, 0, joint.axis);
    turn_off_other_pdos(setup, joint.node);  // of the first axis, whose identifiers are taken
    first = setup.size();
  }
  turn_off_other_pdos(setup, joint.node);
  map_pdo1(setup, joint);
  cia402::append_motion_settings(setup, joint, configuration.scaling(axis), configuration->period);
  if constexpr (cia402::kMostAxes > 1) cia402::move_to_axis(setup, first, joint.axis);
  return setup;
}

}  // namespace armsig::canopen
