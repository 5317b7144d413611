// SPDX-License-Identifier: MIT
// Where the receivers of a range sensor stand, and whether they can locate a target at all.
#pragma once

#include "core/base/error.hpp"
#include "core/base/flight_time.hpp"
#include "core/base/pose.hpp"

namespace armsig::measurement {

using Points = FixedVector<Vector3, kMaxReceivers>;

struct ReceiverArray {
  Points p_S;                // metres, in the sensor frame S
  double range_sigma_m = 0;  // 1 sigma of the range of a single ping; the same for all receivers
  // Where targets can be, for an array that can't tell by itself: those points p with
  // (p - centroid of the receivers) . facing_S > 0. Three receivers, or more in one plane, need it,
  // because they hear a target and its mirror image alike; best perpendicular to that plane.
  Vector3 facing_S = Vector3::Zero();  // of any length; zero: anywhere
};

// Centroid, and the directions in which points spread, widest first.
struct Spread {
  Vector3 centroid = Vector3::Zero();
  Matrix3 axes = Matrix3::Identity();  // columns: unit, orthogonal
  Vector3 rms = Vector3::Zero();       // root mean square of the points along each axis, metres

  // Points this close to a line or plane, for their extent, count as lying in it. A millimetre per
  // metre is as well as receivers are surveyed; whether what sticks out of a plane suffices to tell
  // a target from its mirror image at the sigma of the ranges is decided for each target anew.
  static constexpr double kFlat = 1e-3;
  [[nodiscard]] bool on_a_line() const { return rms(1) <= kFlat * rms(0); }
  [[nodiscard]] bool in_a_plane() const { return rms(2) <= kFlat * rms(0); }
};

// Of at least one point.
[[nodiscard]] Spread spread_of(const Points& points);

// To be asked once, when a sensor description is read.
// Errors: kNotFinite; kNotPositive (range_sigma_m); kTooFewReceivers (fewer than three);
// kReceiversCollinear; kMirrorAmbiguity: all in one plane, and facing_S is absent or lies in it.
[[nodiscard]] Result<void> check(const ReceiverArray& array);

}  // namespace armsig::measurement
