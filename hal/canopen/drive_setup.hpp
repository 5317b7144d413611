// SPDX-License-Identifier: MIT
// The SDO requests that set up one CiA 402 drive, in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "core/base/fixed_vector.hpp"
#include "hal/canopen/configuration.hpp"
#include "hal/canopen/sdo_client.hpp"

namespace armsig::canopen {

// What the answer to a request of the set-up must be.
enum class SetupRule : std::uint8_t {
  kMust,            // any abort ends the set-up
  kIfPresent,       // an object that the device lacks is passed over
  kMustEqual,       // reads: the value under the mask must be `expected`
  kWaitsEqual,      // reads: as kMustEqual, but the device is given some time to get there
  kEqualIfPresent,  // reads: the value must be `expected`, unless the device lacks the object
};

struct SetupStep {
  SdoRequest request;
  SetupRule rule = SetupRule::kMust;
  std::uint32_t mask = 0;
  std::uint32_t expected = 0;
};

inline constexpr std::size_t kMaxSetupSteps = 56;
using DriveSetup = FixedVector<SetupStep, kMaxSetupSteps>;

// Type and mode are checked, identity and factor group (factors.hpp) read, heartbeats both ways
// set, every PDO switched off, RPDO1 and TPDO1 mapped and switched on (in the order that CiA
// 301, 7.5.2.36 demands: PDO off, entries to zero, entries, their number, PDO on), then
// interpolation period, stop behaviour and mode. Polarity (607Eh) must be none, as the sense of a
// joint is ours to turn; a position offset (60B0h) is zeroed, and read to be zero.
[[nodiscard]] DriveSetup drive_setup(const CheckedConfiguration& configuration, std::size_t axis);

// The error that `outcome` of `step` means; empty if the set-up may go on.
// Errors: kSdoTimeout, kSdoAborted, kDriveWrongType, kSdoUnexpectedValue.
[[nodiscard]] std::optional<Error> judge(const SetupStep& step, const SdoOutcome& outcome);

}  // namespace armsig::canopen
