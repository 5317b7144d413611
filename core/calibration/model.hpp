// SPDX-License-Identifier: MIT
// The arm as sections 8 and 9 of ALGORITHMS model it: the drawing, small deviations of every
// joint's axis and zero from it, gravity, and a map of each reading.
//
//   X_ST(q) = X_SB prod_i E_i M_i(t_i) A_i,  t_i = q_i + zero_i + sag_i(q) + map_i(q_i),
// E_i a small rotation about and shift along x, y of joint i's frame, M_i its motion about or along
// z, A_i what the drawing has between it and the next joint.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/reading_map.hpp"

namespace armsig::calibration {

// More than any arm of eight joints has (those of a UR: 10).
inline constexpr std::size_t kMaxGravityTerms = 28;
// Deviations of a joint: rotation x, y [rad], shift x, y [m], zero [rad or m].
inline constexpr std::size_t kDeviations = 5;

// Joint `joint` gives way by `coefficient` [rad or m per m] times the lever of a weight at link
// origin `origin` about (along) its axis.
struct GravityTerm {
  std::uint8_t joint = 0;
  std::uint8_t origin = 0;
  double coefficient = 0;
};

struct JointModel {
  JointType type = JointType::kRevolute;
  double offset = 0;  // of the drawing: turned by effective reading + offset
  Pose after;         // A_i
  std::array<double, kDeviations> deviation{};
  MapDomain domain;
  MapCoefficients map{};
  // Variance of the map at its knots, in units of map_unit() squared, as far as known.
  std::array<float, kKnots> map_variance{};
  // Encoder readings between which the rows were; unknown where both are the same.
  JointLimits covered;
};

struct ArmModel {
  JointCouplings couplings;
  FixedVector<JointModel, kMaxJoints> joints;
  FixedVector<GravityTerm, kMaxGravityTerms> gravity;
  Pose X_SB;

  [[nodiscard]] std::size_t joint_count() const { return joints.size(); }
};

// The drawing, standing at X_SB, without deviations, gravity and maps.
[[nodiscard]] ArmModel model_of(const Arm& arm, const Pose& X_SB);

// Sets the gravity terms that this drawing can tell apart, with coefficients of zero: of every
// joint, those of the origins of the links beyond it whose levers over the joint limits are not
// zero and no sum of others.
void choose_gravity_terms(const Arm& arm, ArmModel& model);

// The levers [m] (1 for a slide along the vertical) of the model's gravity terms at these readings,
// by the drawing; its base stands upright, z up.
using GravityLevers = std::array<double, kMaxGravityTerms>;
void gravity_levers(const ArmModel& model, const JointVector& effective, GravityLevers& levers);

// Joint `joint`'s map [rad or m] at a reading.
[[nodiscard]] double map_at(const JointModel& joint, double reading);

// By how much gravity and maps turn or shift the joints at encoder readings `readings`.
void deflections(const ArmModel& model, const JointVector& readings,
                 std::array<double, kMaxJoints>& by);

// Variance [rad^2 or m^2] of joint `joint`'s map at a reading.
[[nodiscard]] double map_variance_at(const JointModel& joint, double reading);

// One configuration of the chain up to a link.
struct ChainFrames {
  std::array<Pose, kMaxJoints> X_SJ;  // of joint i, before its motion: z along its axis
  Pose X_SL;                          // of the link asked for
  GravityLevers levers{};
  std::array<SplineSupport, kMaxJoints> support;
};

// Everything at joint readings `readings`, of the joints before link `link` (n: the last).
void evaluate_chain(const ArmModel& model, const JointVector& readings, std::size_t link,
                    ChainFrames& frames);

}  // namespace armsig::calibration
