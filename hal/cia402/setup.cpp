// SPDX-License-Identifier: MIT
#include "hal/cia402/setup.hpp"

#include <algorithm>
#include <array>
#include <chrono>

namespace armsig::cia402 {
namespace {

constexpr std::uint16_t kFollowingWindow = 0x6065;
constexpr std::uint16_t kPolarity = 0x607E;
constexpr std::uint16_t kProfileSpeed = 0x6081;
constexpr std::uint16_t kProfileAcceleration = 0x6083;
constexpr std::uint16_t kProfileDeceleration = 0x6084;
constexpr std::uint16_t kPositionOffset = 0x60B0;
constexpr std::uint16_t kInterpolationType = 0x60C0;
constexpr std::uint16_t kInterpolationPeriod = 0x60C2;
constexpr std::uint16_t kInterpolationBuffer = 0x60C4;
constexpr std::uint8_t kBufferAccess = 6;  // of its sub-indices

// Values of those objects.
constexpr std::uint32_t kProfileMask = 0xFFFF;
constexpr std::uint32_t kProfile402 = 402;
constexpr std::uint32_t kLinear = 0;
constexpr std::uint32_t kOpen = 1;  // to what the positions are written to
constexpr std::uint32_t kAbortConnectionQuickStop = 3;
constexpr std::uint32_t kQuickStopRampAndStay = 6;
constexpr std::uint32_t kRampThenDisable = 1;
constexpr std::uint32_t kQuickStopRampThenFault = 2;
constexpr std::uint32_t kPositionReversed = 0x80;

// What is as safe as those: a stop that ends at rest. 605Ah: any ramp, whether the drive stays or
// goes to Switch on disabled after it. 605Ch is commanded at standstill alone, 605Bh never under
// torque. 605Eh: both ramps.
constexpr std::uint32_t kAnyRamp = 0b1'1110'1110;
constexpr std::uint32_t kOffOrRamp = 0b11;
constexpr std::uint32_t kFaultRamps = 0b110;

// Of the profile area, what a set-up is about: written, or held against what is configured.
constexpr std::array<std::uint16_t, 26> kOurs{kAbortConnectionOption,
                                              kControlWord,
                                              kQuickStopOption,
                                              kShutdownOption,
                                              kDisableOperationOption,
                                              kFaultReactionOption,
                                              kModeOfOperation,
                                              kFollowingWindow,
                                              kTargetPosition,
                                              kPolarity,
                                              kQuickStopDeceleration,
                                              0x608F,
                                              0x6091,
                                              0x6092,
                                              0x6093,
                                              kHomingMethod,
                                              0x60A8,
                                              0x60AA,
                                              kPositionOffset,
                                              kInterpolationType,
                                              kInterpolationData,
                                              kInterpolationPeriod,
                                              kInterpolationBuffer,
                                              0x60B1,
                                              0x60B2,
                                              0x6071};

constexpr std::uint32_t kept_bits(std::uint8_t bytes) { return 0xFFFFFFFFU >> (8U * (4U - bytes)); }

}  // namespace

void write(Setup& setup, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
           std::uint32_t value, SetupRule rule) {
  setup.push_back({{index, subindex, bytes, value}, rule, 0, 0});
}

void expect(Setup& setup, std::uint16_t index, SetupRule rule, std::uint32_t mask,
            std::uint32_t expected) {
  setup.push_back({{index, 0, 0, 0}, rule, mask, expected});
}

void prefer(Setup& setup, const ObjectRequest& request, std::uint32_t safe, SetupRule rule) {
  setup.push_back({request, rule, safe, 0});
}

// 1000h tells the profile of the first axis; another one may tell its own.
void append_profile_check(Setup& setup, const DriveSettings& settings) {
  const auto mode = static_cast<std::uint32_t>(settings.position_mode());
  const std::uint32_t supports = 1U << (mode - 1);
  if (kMostAxes > 1 && settings.axis > 1) {
    expect(setup, kLogicalDeviceType, SetupRule::kEqualIfPresent, kProfileMask, kProfile402);
  } else {
    expect(setup, kDeviceType, SetupRule::kMustEqual, kProfileMask, kProfile402);
  }
  expect(setup, kSupportedModes, SetupRule::kEqualIfPresent, supports, supports);
  expect(setup, kPolarity, SetupRule::kEqualIfPresent, kPositionReversed, 0);
  // Of any value.
  if (settings.tells_torque()) expect(setup, kActualTorque, SetupRule::kMustEqual, 0, 0);
}

namespace {

// How the drive gets from target to target.
void append_mode_settings(Setup& setup, PositionMode mode, hal::Duration period) {
  if (mode == PositionMode::kProfile) {
    for (const auto index : {kProfileSpeed, kProfileAcceleration, kProfileDeceleration}) {
      expect(setup, index, SetupRule::kNotZero, 0xFFFFFFFF, 1);
    }
    return;
  }
  const InterpolationPeriod interpolation = *interpolation_period(period);
  prefer(setup, {kInterpolationPeriod, 1, 1, interpolation.value}, 0);
  prefer(setup, {kInterpolationPeriod, 2, 1, static_cast<std::uint8_t>(interpolation.exponent)}, 0);
  if (mode == PositionMode::kInterpolated) {
    prefer(setup, {kInterpolationType, 0, 2, kLinear}, 0);
    prefer(setup, {kInterpolationBuffer, kBufferAccess, 1, kOpen}, kAnyValue);
  }
}

}  // namespace

bool may_be_written(std::uint16_t index) {
  constexpr std::uint16_t kFirstOfMaker = 0x2000;
  constexpr std::uint16_t kFirstOfProfile = 0x6000;
  constexpr std::uint16_t kLastOfProfile = 0x67FF;
  if (index < kFirstOfMaker || index > kLastOfProfile) return false;
  return index < kFirstOfProfile || std::ranges::find(kOurs, index) == kOurs.end();
}

void append_motion_settings(Setup& setup, const DriveSettings& settings, const Scaling& scaling,
                            hal::Duration period) {
  const PositionMode mode = settings.position_mode();
  for (const ObjectRequest& further : settings.further_writes()) {
    write(setup, further.index, further.subindex, further.bytes, further.value,
          SetupRule::kSetting);
  }
  append_mode_settings(setup, mode, period);
  prefer(setup, {kAbortConnectionOption, 0, 2, kAbortConnectionQuickStop}, kAnyValue);
  prefer(setup, {kQuickStopOption, 0, 2, kQuickStopRampAndStay}, kAnyRamp);
  prefer(setup, {kShutdownOption, 0, 2, kRampThenDisable}, kAnyValue);
  prefer(setup, {kDisableOperationOption, 0, 2, kRampThenDisable}, kOffOrRamp);
  prefer(setup, {kFaultReactionOption, 0, 2, kQuickStopRampThenFault}, kFaultRamps);
  if (settings.stop_deceleration > 0) {
    write(setup, kQuickStopDeceleration, 0, 4, *scaling.distance_counts(settings.stop_deceleration),
          SetupRule::kSetting);
  }
  prefer(setup, {kPositionOffset, 0, 4, 0}, 0);
  if (settings.following_window > 0) {
    write(setup, kFollowingWindow, 0, 4, *scaling.distance_counts(settings.following_window),
          SetupRule::kSetting);
  }
  write(setup, kModeOfOperation, 0, 1, static_cast<std::uint32_t>(mode));
  expect(setup, kModeDisplay, SetupRule::kTold, 0xFF, static_cast<std::uint32_t>(mode));
}

void move_to_axis(Setup& setup, std::size_t first, std::uint8_t axis) {
  for (std::size_t i = first; i < setup.size(); ++i) {
    setup[i].request.index = object_of_axis(axis, setup[i].request.index);
  }
}

bool is_absent(const ObjectOutcome& outcome) {
  if (outcome || outcome.error().error != Error::kSdoAborted) return false;
  const std::uint32_t code = outcome.error().abort_code;
  return code == kAbortNoObject || code == kAbortNoSubindex;
}

bool is_wanted(const SetupStep& step, std::uint32_t value) {
  const std::uint32_t kept = kept_bits(step.request.bytes);
  return (value & kept) == (step.request.value & kept);
}

bool is_safe(const SetupStep& step, std::uint32_t value) {
  const std::uint32_t kept = value & kept_bits(step.request.bytes);
  return step.mask == kAnyValue || (kept < 32 && (step.mask >> kept & 1U) != 0);
}

std::optional<Error> judge(const SetupStep& step, const ObjectOutcome& outcome) {
  if (!outcome) {
    const bool optional = step.rule == SetupRule::kIfPresent ||
                          step.rule == SetupRule::kEqualIfPresent ||
                          (hal::kOtherModes && step.rule == SetupRule::kNotZero);
    if (optional && is_absent(outcome)) return std::nullopt;
    return outcome.error().error;
  }
  if (hal::kOtherModes && step.rule == SetupRule::kNotZero && *outcome == 0)
    return Error::kSdoUnexpectedValue;
  const bool compared =
      step.rule == SetupRule::kMustEqual || step.rule == SetupRule::kEqualIfPresent;
  if (!compared || (*outcome & step.mask) == step.expected) return std::nullopt;
  const std::uint16_t index = object_of_first_axis(step.request.index);
  const bool of_type = index == kDeviceType || index == kSupportedModes ||
                       (kMostAxes > 1 && index == kLogicalDeviceType);
  return of_type ? Error::kDriveWrongType : Error::kSdoUnexpectedValue;
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
