// SPDX-License-Identifier: MIT
// What can go wrong in the world: one enumeration for core, hal and the controller.
//
// Mistakes of ours are assertions (core/base/check.hpp); what a sensor, a drive, a file or a person
// can do to us is an Error inside a std::expected, and every function lists the ones it can return.
#pragma once

#include <cstdint>
#include <expected>
#include <string_view>
#include <utility>

namespace armsig {

enum class Error : std::uint8_t {
  // Any stage.
  kNotFinite,         // a number is NaN or infinite
  kCapacityExceeded,  // more items than the fixed capacity holds
  kNotConverged,      // an iteration used up its bound
  kSingular,          // equations without a unique solution
  kNotPositive,       // a length or a sigma that must be positive is not
  // Measurement.
  kTooFewReceivers,     // fewer than three receivers, or fewer than three heard the target
  kReceiversCollinear,  // the receivers stand on one line
  kMirrorAmbiguity,  // the receivers stand in one plane and nothing says on which side the target
                     // is
  kRangesInconsistent,  // the ranges do not meet in a point
  kTemperatureImplausible,
  // Features.
  kTooFewPoints,      // fewer points than unknowns
  kCoincidentPoints,  // the target did not move while the joint did
  kJointDidNotMove,   // every row has the same reading
  kArcTooShort,       // the arc swept does not determine the axis
  kRadiusTooSmall,    // the target is on the axis
  kTooManyOutliers,   // no circle or line explains half of the points
  kNotACircle,  // residuals far above the noise stated: another joint moved, or the reading is
                // coupled
  // Identification.
  kJointOutOfRange,                // a joint number outside the arm
  kJointNotSwept,                  // a joint without a sweep
  kHeldJointMoved,                 // another joint moved during a sweep
  kSignatureConfigurationDiffers,  // two sweeps hold a joint at different readings
  kMirroredSense,                  // a joint turns against the sense of the arm description
  // Refinement.
  kScaleUndetermined,  // the scale was asked for, and nothing in the log has a known length
  // Kinematics.
  kOutOfReach,
  kJointLimit,
};

// A short English phrase for `error`, without a full stop.
[[nodiscard]] std::string_view describe(Error error);

template <typename T>
using Result = std::expected<T, Error>;

// An error with the two numbers that a person needs to see: what was found, and what was needed (SI
// units; for kArcTooShort the arc and the least arc, for kRadiusTooSmall the radius and the least
// radius, ...).
struct Refusal {
  Error error = Error::kNotFinite;
  double found = 0;
  double needed = 0;
};

template <typename T>
using Judged = std::expected<T, Refusal>;

}  // namespace armsig

// NOLINTBEGIN(bugprone-macro-parentheses): `name` is declared, and can't be in parentheses
// ARMSIG_TRY(name, expression): binds `name` to the value of a Result, or returns its error from
// this function.
#define ARMSIG_TRY(name, expression)                                                \
  auto name##_or_error = (expression);                                              \
  if (!name##_or_error) return std::unexpected(std::move(name##_or_error).error()); \
  auto& name = *name##_or_error
// NOLINTEND(bugprone-macro-parentheses)
