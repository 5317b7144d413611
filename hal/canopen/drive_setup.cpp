// SPDX-License-Identifier: MIT
#include "hal/canopen/drive_setup.hpp"

#include <chrono>

#include "hal/canopen/factors.hpp"
#include "hal/canopen/identity.hpp"

namespace armsig::canopen {
namespace {

// Objects of CiA 301.
constexpr std::uint16_t kDeviceType = 0x1000;
constexpr std::uint16_t kHeartbeatConsumer = 0x1016;
constexpr std::uint16_t kHeartbeatProducer = 0x1017;
constexpr std::uint16_t kReceivePdoParameter = 0x1400;
constexpr std::uint16_t kReceivePdoMapping = 0x1600;
constexpr std::uint16_t kTransmitPdoParameter = 0x1800;
constexpr std::uint16_t kTransmitPdoMapping = 0x1A00;
// Objects of CiA 402.
constexpr std::uint16_t kAbortConnectionOption = 0x6007;
constexpr std::uint16_t kQuickStopOption = 0x605A;
constexpr std::uint16_t kShutdownOption = 0x605B;
constexpr std::uint16_t kDisableOperationOption = 0x605C;
constexpr std::uint16_t kFaultReactionOption = 0x605E;
constexpr std::uint16_t kModeOfOperation = 0x6060;
constexpr std::uint16_t kModeDisplay = 0x6061;
constexpr std::uint16_t kFollowingWindow = 0x6065;
constexpr std::uint16_t kPolarity = 0x607E;
constexpr std::uint16_t kQuickStopDeceleration = 0x6085;
constexpr std::uint16_t kPositionOffset = 0x60B0;
constexpr std::uint16_t kInterpolationPeriod = 0x60C2;
constexpr std::uint16_t kSupportedModes = 0x6502;

// Values of those objects.
constexpr std::uint32_t kProfileMask = 0xFFFF;
constexpr std::uint32_t kProfile402 = 402;
constexpr std::uint32_t kSupportsCsp = 1U << 7;
constexpr std::uint32_t kModeCsp = 8;
constexpr std::uint32_t kAbortConnectionQuickStop = 3;
constexpr std::uint32_t kQuickStopRampAndStay = 6;
constexpr std::uint32_t kRampThenDisable = 1;
constexpr std::uint32_t kQuickStopRampThenFault = 2;
constexpr std::uint32_t kPositionReversed = 0x80;
constexpr std::uint32_t kOnEverySync = 1;
constexpr std::uint32_t kControlWordEntry = 0x60400010;
constexpr std::uint32_t kTargetPositionEntry = 0x607A0020;
constexpr std::uint32_t kStatusWordEntry = 0x60410010;
constexpr std::uint32_t kActualPositionEntry = 0x60640020;

constexpr std::uint16_t kOtherPdos = 3;  // PDO2 to PDO4, which may be on after power-up

void write(DriveSetup& setup, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
           std::uint32_t value, SetupRule rule = SetupRule::kMust) {
  setup.push_back({{index, subindex, bytes, value}, rule, 0, 0});
}

void expect(DriveSetup& setup, std::uint16_t index, SetupRule rule, std::uint32_t mask,
            std::uint32_t expected) {
  setup.push_back({{index, 0, 0, 0}, rule, mask, expected});
}

struct Pdo {
  std::uint16_t parameter;
  std::uint16_t mapping;
  std::uint32_t id;
  std::uint32_t flags;
  std::uint32_t first_entry;
  std::uint32_t second_entry;
};

void map(DriveSetup& setup, const Pdo& pdo) {
  write(setup, pdo.parameter, 1, 4, kPdoOff | pdo.flags | pdo.id);
  write(setup, pdo.parameter, 2, 1, kOnEverySync);
  write(setup, pdo.mapping, 0, 1, 0);
  write(setup, pdo.mapping, 1, 4, pdo.first_entry);
  write(setup, pdo.mapping, 2, 4, pdo.second_entry);
  write(setup, pdo.mapping, 0, 1, 2);
  write(setup, pdo.parameter, 1, 4, pdo.flags | pdo.id);
}

std::uint32_t milliseconds_of(hal::Duration time) {
  return static_cast<std::uint32_t>(time / std::chrono::milliseconds(1));
}

}  // namespace

DriveSetup drive_setup(const CheckedConfiguration& configuration, std::size_t axis) {
  const AxisConfiguration& joint = configuration->axes[axis];
  DriveSetup setup;
  expect(setup, kDeviceType, SetupRule::kMustEqual, kProfileMask, kProfile402);
  expect(setup, kSupportedModes, SetupRule::kMustEqual, kSupportsCsp, kSupportsCsp);
  append_identity_requests(setup);
  append_factor_requests(setup);
  write(setup, kHeartbeatProducer, 0, 2, milliseconds_of(configuration->heartbeat));
  write(setup, kHeartbeatConsumer, 1, 4,
        (static_cast<std::uint32_t>(configuration->master_node) << 16) |
            milliseconds_of(configuration->heartbeat_timeout));
  for (std::uint16_t pdo = 1; pdo <= kOtherPdos; ++pdo) {
    const std::uint32_t step = 0x100U * pdo + joint.node;
    write(setup, static_cast<std::uint16_t>(kReceivePdoParameter + pdo), 1, 4,
          kPdoOff | (kReceivePdo1Id + step), SetupRule::kIfPresent);
    write(setup, static_cast<std::uint16_t>(kTransmitPdoParameter + pdo), 1, 4,
          kPdoOff | kNoRemote | (kTransmitPdo1Id + step), SetupRule::kIfPresent);
  }
  map(setup, {kReceivePdoParameter, kReceivePdoMapping, kReceivePdo1Id + joint.node, 0,
              kControlWordEntry, kTargetPositionEntry});
  map(setup, {kTransmitPdoParameter, kTransmitPdoMapping, kTransmitPdo1Id + joint.node, kNoRemote,
              kStatusWordEntry, kActualPositionEntry});
  const InterpolationPeriod period = *interpolation_period(configuration->period);
  write(setup, kInterpolationPeriod, 1, 1, period.value);
  write(setup, kInterpolationPeriod, 2, 1, static_cast<std::uint8_t>(period.exponent));
  write(setup, kAbortConnectionOption, 0, 2, kAbortConnectionQuickStop, SetupRule::kIfPresent);
  write(setup, kQuickStopOption, 0, 2, kQuickStopRampAndStay, SetupRule::kIfPresent);
  write(setup, kShutdownOption, 0, 2, kRampThenDisable, SetupRule::kIfPresent);
  write(setup, kDisableOperationOption, 0, 2, kRampThenDisable, SetupRule::kIfPresent);
  write(setup, kFaultReactionOption, 0, 2, kQuickStopRampThenFault, SetupRule::kIfPresent);
  if (joint.stop_deceleration > 0) {
    write(setup, kQuickStopDeceleration, 0, 4,
          *configuration.scaling(axis).distance_counts(joint.stop_deceleration));
  }
  expect(setup, kPolarity, SetupRule::kEqualIfPresent, kPositionReversed, 0);
  write(setup, kPositionOffset, 0, 4, 0, SetupRule::kIfPresent);
  expect(setup, kPositionOffset, SetupRule::kEqualIfPresent, 0xFFFFFFFF, 0);
  if (joint.following_window > 0) {
    write(setup, kFollowingWindow, 0, 4,
          *configuration.scaling(axis).distance_counts(joint.following_window));
  }
  write(setup, kModeOfOperation, 0, 1, kModeCsp);
  expect(setup, kModeDisplay, SetupRule::kWaitsEqual, 0xFF, kModeCsp);
  return setup;
}

std::optional<Error> judge(const SetupStep& step, const SdoOutcome& outcome) {
  if (!outcome) {
    const std::uint32_t code = outcome.error().abort_code;
    const bool absent = outcome.error().error == Error::kSdoAborted &&
                        (code == kAbortNoObject || code == kAbortNoSubindex);
    const bool optional =
        step.rule == SetupRule::kIfPresent || step.rule == SetupRule::kEqualIfPresent;
    if (absent && optional) return std::nullopt;
    return outcome.error().error;
  }
  const bool reads = step.rule != SetupRule::kMust && step.rule != SetupRule::kIfPresent;
  if (!reads || (*outcome & step.mask) == step.expected) return std::nullopt;
  return step.rule == SetupRule::kMustEqual ? Error::kDriveWrongType : Error::kSdoUnexpectedValue;
}

}  // namespace armsig::canopen
