// SPDX-License-Identifier: MIT
// The factor group of CiA 402-2: what a drive says of its own counts, against what is configured.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "hal/cia402/scaling.hpp"
#include "hal/cia402/setup.hpp"

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
  Factor encoder;  // 608Fh: increments a motor revolution
  Factor gear;     // 6091h: motor revolutions a revolution of the output
  Factor feed;     // 6092h: position units a revolution of the output
};

void append_factor_requests(Setup& setup);
// The answer to one of those requests; any other is passed over.
void take_factor(const ObjectRequest& request, const ObjectOutcome& outcome, DriveFactors& factors);

// The object by which positions (6064h) count otherwise than `scaling` says; empty: they agree, or
// the drive does not tell. Positions are in units of feed / gear a motor revolution where the drive
// has a feed (CiA 402-2, position factor group), else in increments of the encoder; a gear other
// than 1:1 is that of the joint.
[[nodiscard]] std::optional<std::uint16_t> contradicting_object(
    const DriveFactors& factors, const ScalingConfiguration& scaling);

}  // namespace armsig::cia402
