// SPDX-License-Identifier: MIT
#include "hal/cia402/setup.hpp"

#include <chrono>

namespace armsig::cia402 {
namespace {

constexpr std::uint16_t kDeviceType = 0x1000;  // of CiA 301: the number of the profile
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
}  // namespace

void write(Setup& setup, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
           std::uint32_t value, SetupRule rule) {
  setup.push_back({{index, subindex, bytes, value}, rule, 0, 0});
}

void expect(Setup& setup, std::uint16_t index, SetupRule rule, std::uint32_t mask,
            std::uint32_t expected) {
  setup.push_back({{index, 0, 0, 0}, rule, mask, expected});
}

void append_profile_check(Setup& setup) {
  expect(setup, kDeviceType, SetupRule::kMustEqual, kProfileMask, kProfile402);
  expect(setup, kSupportedModes, SetupRule::kMustEqual, kSupportsCsp, kSupportsCsp);
}

void append_motion_settings(Setup& setup, const DriveSettings& settings, const Scaling& scaling,
                            hal::Duration period) {
  const InterpolationPeriod interpolation = *interpolation_period(period);
  write(setup, kInterpolationPeriod, 1, 1, interpolation.value);
  write(setup, kInterpolationPeriod, 2, 1, static_cast<std::uint8_t>(interpolation.exponent));
  write(setup, kAbortConnectionOption, 0, 2, kAbortConnectionQuickStop, SetupRule::kIfPresent);
  write(setup, kQuickStopOption, 0, 2, kQuickStopRampAndStay, SetupRule::kIfPresent);
  write(setup, kShutdownOption, 0, 2, kRampThenDisable, SetupRule::kIfPresent);
  write(setup, kDisableOperationOption, 0, 2, kRampThenDisable, SetupRule::kIfPresent);
  write(setup, kFaultReactionOption, 0, 2, kQuickStopRampThenFault, SetupRule::kIfPresent);
  if (settings.stop_deceleration > 0) {
    write(setup, kQuickStopDeceleration, 0, 4,
          *scaling.distance_counts(settings.stop_deceleration));
  }
  expect(setup, kPolarity, SetupRule::kEqualIfPresent, kPositionReversed, 0);
  write(setup, kPositionOffset, 0, 4, 0, SetupRule::kIfPresent);
  expect(setup, kPositionOffset, SetupRule::kEqualIfPresent, 0xFFFFFFFF, 0);
  if (settings.following_window > 0) {
    write(setup, kFollowingWindow, 0, 4, *scaling.distance_counts(settings.following_window));
  }
  write(setup, kModeOfOperation, 0, 1, kModeCsp);
  expect(setup, kModeDisplay, SetupRule::kWaitsEqual, 0xFF, kModeCsp);
}

std::optional<Error> judge(const SetupStep& step, const ObjectOutcome& outcome) {
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

std::optional<InterpolationPeriod> interpolation_period(hal::Duration period) {
  struct Unit {
    hal::Duration length;
    std::int8_t exponent;
  };
  for (const Unit& unit :
       {Unit{std::chrono::milliseconds(1), -3}, Unit{std::chrono::microseconds(100), -4},
        Unit{std::chrono::microseconds(10), -5}}) {
    const auto value = period / unit.length;
    if (period % unit.length == hal::Duration::zero() && value >= 1 && value <= 255 &&
        period >= std::chrono::microseconds(100)) {
      return InterpolationPeriod{static_cast<std::uint8_t>(value), unit.exponent};
    }
  }
  return std::nullopt;
}

}  // namespace armsig::cia402
