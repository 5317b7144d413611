// SPDX-License-Identifier: MIT
// The objects of CiA 402 that are checked and written while a drive is set up, in order, and by
// which rule each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/cia402/object.hpp"
#include "hal/cia402/settings.hpp"

namespace armsig::cia402 {

// What the answer to a request of the set-up must be.
enum class SetupRule : std::uint8_t {
  kMust,            // writes: any abort ends the set-up
  kIfPresent,       // reads or writes: an object that the device lacks is passed over
  kSetting,         // written unless it reads as wanted already; any abort ends the set-up
  kOption,          // as SetupStep::mask says
  kInstead,         // as kOption, but only while nothing else makes the device watch its master
  kMustEqual,       // reads: the value under the mask must be `expected`
  kEqualIfPresent,  // reads: the value must be `expected`, unless the device
                    // lacks the object
  kNotZero,         // reads: the value must not be 0, unless the device lacks the object
  kTold,            // reads: any value will do now
};

struct SetupStep {
  ObjectRequest request;
  SetupRule rule = SetupRule::kMust;
  // Of an option: bit v says that the value v is as safe as the one wanted. An option is read,
  // written where it holds another value than the one wanted, and read again. It passes where it
  // then holds that or a safe one, and where the device lacks it. Else of what is read.
  std::uint32_t mask = 0;
  std::uint32_t expected = 0;
};

// An option that may hold anything.
inline constexpr std::uint32_t kAnyValue = 0xFFFFFFFF;

// PDO2 to PDO4 of the first axis, whose identifiers another one takes.
inline constexpr std::size_t kFirstAxisSteps = kMostAxes > 1 ? 6 : 0;
inline constexpr std::size_t kMaxSetupSteps =
    58 + kFirstAxisSteps + (hal::kOtherModes ? 4 + kMaxFurtherWrites : 0);
using Setup = FixedVector<SetupStep, kMaxSetupSteps>;

// One more step: writes an object, or reads one and holds it against `expected`.
void write(Setup& setup, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
           std::uint32_t value, SetupRule rule = SetupRule::kMust);
void expect(Setup& setup, std::uint16_t index, SetupRule rule, std::uint32_t mask,
            std::uint32_t expected);
// An option; `safe` as SetupStep::mask.
void prefer(Setup& setup, const ObjectRequest& request, std::uint32_t safe,
            SetupRule rule = SetupRule::kOption);

// The device, or its axis, is a drive of CiA 402 that knows the mode, if it tells its modes.
// Polarity (607Eh) must be none, as the sense of a joint is ours to turn. It has the torque that it
// is to tell.
void append_profile_check(Setup& setup, const DriveSettings& settings);
// Interpolation period, stop behaviour, window, mode; a position offset (60B0h) must be zero. A
// drive that makes its own profiles must have a speed and accelerations for them. The quick stop
// ramp is in counts until the drive has told its unit (SetupRun).
// Preconditions: interpolation_period(period); the distances of `settings` fit into counts.
void append_motion_settings(Setup& setup, const DriveSettings& settings, const Scaling& scaling,
                            hal::Duration period);

// Whether a configuration may write an object besides: one of the maker (2000h to 5FFFh), or one of
// the profile that no set-up writes or holds against what is configured.
[[nodiscard]] bool may_be_written(std::uint16_t index);

// Of the steps that are no option, setting or told: the error that `outcome` of `step` means;
// empty if the set-up may go on.
// Errors: kSdoTimeout, kSdoAborted, kDriveWrongType, kSdoUnexpectedValue.
[[nodiscard]] std::optional<Error> judge(const SetupStep& step, const ObjectOutcome& outcome);

// Whether the device lacks the object that it was asked for.
[[nodiscard]] bool is_absent(const ObjectOutcome& outcome);
// Whether an option or setting is wanted to hold `value`, or else is as safe with it.
[[nodiscard]] bool is_wanted(const SetupStep& step, std::uint32_t value);
[[nodiscard]] bool is_safe(const SetupStep& step, std::uint32_t value);
[[nodiscard]] constexpr bool is_option(SetupRule rule) {
  return rule == SetupRule::kOption || rule == SetupRule::kInstead;
}

// The steps from number `first` on name the objects of the first axis; now they name those of
// `axis`.
void move_to_axis(Setup& setup, std::size_t first, std::uint8_t axis);

// The interpolation period as object 60C2h wants it: value times 10^exponent seconds.
struct InterpolationPeriod {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
};
// Empty if `period` is no such number between 0.1 ms and 255 ms.
[[nodiscard]] std::optional<InterpolationPeriod> interpolation_period(hal::Duration period);

}  // namespace armsig::cia402
