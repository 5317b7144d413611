// SPDX-License-Identifier: MIT
// The objects of CiA 402 that are checked and written while a drive is set up, in order.
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
  kMust,            // any abort ends the set-up
  kIfPresent,       // an object that the device lacks is passed over
  kMustEqual,       // reads: the value under the mask must be `expected`
  kWaitsEqual,      // reads: as kMustEqual, but the device is given some time to get
                    // there
  kEqualIfPresent,  // reads: the value must be `expected`, unless the device
                    // lacks the object
};

struct SetupStep {
  ObjectRequest request;
  SetupRule rule = SetupRule::kMust;
  std::uint32_t mask = 0;
  std::uint32_t expected = 0;
};

inline constexpr std::size_t kMaxSetupSteps = 56;
using Setup = FixedVector<SetupStep, kMaxSetupSteps>;

// One more step: writes an object, or reads one and holds it against `expected`.
void write(Setup& setup, std::uint16_t index, std::uint8_t subindex, std::uint8_t bytes,
           std::uint32_t value, SetupRule rule = SetupRule::kMust);
void expect(Setup& setup, std::uint16_t index, SetupRule rule, std::uint32_t mask,
            std::uint32_t expected);

// The device is a drive of CiA 402 that knows cyclic synchronous positions.
void append_profile_check(Setup& setup);
// Interpolation period, stop behaviour, window, mode. Polarity (607Eh) must be none, as the sense
// of a joint is ours to turn; a position offset (60B0h) is zeroed, and read to be zero.
// Preconditions: interpolation_period(period); the distances of `settings` fit into counts.
void append_motion_settings(Setup& setup, const DriveSettings& settings, const Scaling& scaling,
                            hal::Duration period);

// The error that `outcome` of `step` means; empty if the set-up may go on.
// Errors: kSdoTimeout, kSdoAborted, kDriveWrongType, kSdoUnexpectedValue.
[[nodiscard]] std::optional<Error> judge(const SetupStep& step, const ObjectOutcome& outcome);

// The interpolation period as object 60C2h wants it: value times 10^exponent seconds.
struct InterpolationPeriod {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;
};
// Empty if `period` is no such number between 0.1 ms and 255 ms.
[[nodiscard]] std::optional<InterpolationPeriod> interpolation_period(hal::Duration period);

}  // namespace armsig::cia402
