// SPDX-License-Identifier: MIT
// The factor group of CiA 402-2, and what older drives have instead: what a drive says of its own
// counts and units, against what is configured.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/cia402/scaling.hpp"
#include "hal/cia402/setup.hpp"
#include "hal/device_object.hpp"

namespace armsig::cia402 {

// A quotient of two sub-indices.
struct Factor {
  std::optional<std::uint32_t> over;   // sub-index 1
  std::optional<std::uint32_t> under;  // sub-index 2

  // Empty unless both are told and above zero.
  [[nodiscard]] std::optional<double> value() const;
};

// As far as the drive has them.
struct DriveFactors {
  Factor encoder;                       // 608Fh: increments a motor revolution
  Factor gear;                          // 6091h: motor revolutions a revolution of the output
  Factor feed;                          // 6092h: position units a revolution of the output
  Factor position;                      // 6093h, of the profile's second edition: increments a unit
  std::uint32_t position_unit = 0;      // 60A8h; 0: not told
  std::uint32_t acceleration_unit = 0;  // 60AAh
};

void append_factor_requests(Setup& setup);
// The answer to one of those requests, of any axis; any other is passed over.
void take_factor(const ObjectRequest& request, const ObjectOutcome& outcome, DriveFactors& factors);

// The object by which positions (6064h) count otherwise than `scaling` says; empty: they agree, or
// the drive does not tell. Where 60A8h says increments, they are the encoder's, whatever the feed
// says. Else positions are in units of feed / gear a motor revolution where the drive has a feed
// (CiA 402-2, position factor group), else in the unit of 60A8h where that is an angle, else in
// increments of the encoder over 6093h. A gear other than 1:1 is that of the joint.
[[nodiscard]] std::optional<hal::DeviceObject> contradicting_object(
    const DriveFactors& factors, const ScalingConfiguration& scaling);

// What object 6085h is to be for `deceleration` (rad/s^2 or m/s^2) in the unit of 60AAh: counts,
// revolutions of the motor, or revolutions a minute, each a second (squared). Counts where the
// drive does not tell. Errors: kScaleInvalid (another unit), kPositionOverflow.
[[nodiscard]] Result<std::uint32_t> stop_ramp(const DriveFactors& factors, double deceleration,
                                              const ScalingConfiguration& scaling);

}  // namespace armsig::cia402
