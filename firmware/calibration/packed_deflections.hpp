// SPDX-License-Identifier: MIT
// Gravity and maps of the readings in the few bytes that a controller keeps of them: every map in
// steps of 16 bits, which for a map of 0.02 degrees are 1e-8 rad.
#pragma once

#include <cstdint>

#include "core/arm_model/model.hpp"
#include "core/base/error.hpp"

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

  [[nodiscard]] bool empty() const { return maps.empty(); }
};

// Every map to half a step.
[[nodiscard]] PackedDeflections packed(const ArmModel& model);

// The model of `drawing` with them; variances and covered readings are not known. packed() of it is
// `deflections` again. Precondition: check() accepts `deflections`, of as many joints.
[[nodiscard]] ArmModel unpacked(const PackedDeflections& deflections, const Arm& drawing);

// No map and no lever of those taken turns or shifts a joint by more than this, or moves it by
// more than this for a reading that moves by one: a reading of the servo cannot jump, and its
// inverse converges.
inline constexpr double kLargestDeflection = 0.1;  // rad or m
inline constexpr double kSteepestMap = 0.1;
inline constexpr double kLongestLever_m = 10;

// Of the spline between any two knots: its slopes lie between those of its control polygon.
[[nodiscard]] bool is_bounded(const PackedMap& map);
// Joint and origin are of an arm of `joints` joints, and no lever of the arm is too strong.
[[nodiscard]] bool is_bounded(const GravityTerm& term, std::size_t joints);
// Errors: kOutOfRange (a number that is not finite, a map or a term that is not bounded, maps of
// other joints than `joints`).
[[nodiscard]] Result<void> check(const PackedDeflections& deflections, std::size_t joints);

}  // namespace armsig::calibration
