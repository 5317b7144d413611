// SPDX-License-Identifier: MIT
// Gravity and joint error maps in the few bytes that a controller keeps of them: every map in
// steps of 16 bits, which for a map of 0.02 degrees are 1e-8 rad.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/calibration/model.hpp"

namespace armsig::calibration {

struct PackedMap {
  MapDomain domain;
  double step = 0;  // rad or m
  std::array<std::int16_t, kKnots> steps{};
};

// 2.7 kB. None where there are no maps; else one a joint, with the drawing's zeros.
struct PackedDeflections {
  FixedVector<PackedMap, kMaxJoints> maps;
  std::array<double, kMaxJoints> drawn_zero{};  // JointModel::offset
  FixedVector<GravityTerm, kMaxGravityTerms> gravity;
  Vector3 up_0 = Vector3::UnitZ();  // Arm::up_0, against which the levers are taken

  [[nodiscard]] bool empty() const { return maps.empty(); }
};

// Every map to half a step.
[[nodiscard]] PackedDeflections packed(const ArmModel& model);

// The model of `drawing` with them; variances and covered readings are not known. packed() of it is
// `deflections` again. Precondition: check() accepts `deflections`.
[[nodiscard]] ArmModel unpacked(const PackedDeflections& deflections, const Arm& drawing);

// No map, and no gravity term at the longest lever, turns or shifts a joint by more than this, or
// moves it by more than this for a reading that moves by one: a reading of the servo cannot jump,
// and its inverse converges.
inline constexpr double kLargestDeflection = 0.1;  // rad or m
inline constexpr double kSteepestMap = 0.1;

// No weight is further from an axis: the arm's links laid end to end, its prismatic joints as long
// as their limits let them. At most 10 m: rows of near-parallel axes have a longer d that cancels.
[[nodiscard]] double longest_lever_m(const Arm& nominal);

// Of the spline between any two knots: its slopes lie between those of its control polygon.
[[nodiscard]] bool is_bounded(const PackedMap& map);
// Joint and origin are of `nominal`, and its longest lever gives no deflection that is too large.
[[nodiscard]] bool is_bounded(const GravityTerm& term, const Arm& nominal);
// Errors: kOutOfRange (a number that is not finite, a map or a term that is not bounded, maps of
// other joints than those of `nominal`, up_0 off length 1 by more than 1e-9).
[[nodiscard]] Result<void> check(const PackedDeflections& deflections, const Arm& nominal);

}  // namespace armsig::calibration
