// SPDX-License-Identifier: MIT
// The arm as docs/model.md, section 5, has it: the drawing, small deviations of every
// joint's axis and zero from it, gravity, and a map of each reading.
//
//   X_ST(q) = X_SB prod_i E_i M_i(t_i) A_i,  t_i = c_i(q_i) + zero_i + sag_i(q) + map_i(q_i),
// E_i a small rotation about and shift along x, y of joint i's frame, M_i its motion about or along
// z, A_i what the drawing has between it and the next joint, c_i the corrections of its reading
// that were asked for (calibration::ReadingCorrection).
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/observation.hpp"
#include "core/calibration/parameter.hpp"
#include "core/calibration/reading_map.hpp"
#include "core/calibration/readings.hpp"

namespace armsig::calibration {

// More than any arm of so many joints has whose first axis is vertical (those of a UR: 10), and any
// of seven joints or fewer (28) however it stands.
[[nodiscard]] constexpr std::size_t most_gravity_terms(std::size_t joints) {
  return joints * (joints - 1) / 2;
}
inline constexpr std::size_t kMaxGravityTerms = most_gravity_terms(kMaxJoints);
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
  ReadingCorrection correction;
  MapDomain domain;
  MapCoefficients map{};
  // Variance of the map at its knots, in units of map_unit() squared, as far as known.
  std::array<float, kKnots> map_variance{};
  // Encoder readings between which the rows were; unknown where both are the same.
  JointLimits covered;
};

// The sensor: what it adds to a range of each receiver, and by how much all its lengths are wrong
// (a measured length is (1 + scale) times the true one).
struct SensorModel {
  Receivers receivers;
  std::array<double, kMaxReceivers> offset_m{};
  double scale = 0;
};

// Corrections that may be asked for beside the geometry: of eight joints, receivers and the scale.
inline constexpr std::size_t kMaxFurther = 5 * kMaxJoints + kMaxReceivers + 1;
using FurtherParameters = FixedVector<Parameter, kMaxFurther>;

struct ArmModel {
  JointCouplings couplings;
  Vector3 up_0 = Vector3::UnitZ();  // Arm::up_0
  FixedVector<JointModel, kMaxJoints> joints;
  FixedVector<GravityTerm, kMaxGravityTerms> gravity;
  FurtherParameters further;  // those to be found
  SensorModel sensor;
  Pose X_SB;

  [[nodiscard]] std::size_t joint_count() const { return joints.size(); }
};

// The drawing, standing at X_SB, without deviations, gravity and maps.
[[nodiscard]] ArmModel model_of(const Arm& arm, const Pose& X_SB);

// Sets the gravity terms that this drawing can tell apart, with coefficients of zero: of every
// joint, those of the origins of the links beyond it whose levers over the joint limits are not
// zero and no sum of others. GravityChoice does it by bounded steps.
void choose_gravity_terms(const Arm& arm, ArmModel& model);

// Sets which corrections are to be found, of the values that they have.
void ask_for(const ParameterRequest& request, ArmModel& model);

// The value of one of them. Precondition: its kind is that of a correction.
[[nodiscard]] double& value_of(ArmModel& model, const Parameter& parameter);
[[nodiscard]] double value_of(const ArmModel& model, const Parameter& parameter);

// The levers [m] (1 for a prismatic joint along the vertical) of the model's gravity terms at these
// effective readings, by the nominal rows and up_0.
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
  JointVector effective;              // readings, couplings applied
  GravityLevers levers{};
  std::array<SplineSupport, kMaxJoints> support;
};

// What of the chain no reading moves: joint i's frame before its motion in that of joint i - 1
// after its own; of joint 0, in the sensor's.
struct FixedLinks {
  std::array<Pose, kMaxJoints> X_J;
};
void place_links(const ArmModel& model, FixedLinks& links);

// What the drawing and the readings alone say, of the joints before link `link` (n: the last): the
// effective readings, the levers and the supports.
void look_up(const ArmModel& model, const JointVector& readings, std::size_t link,
             ChainFrames& frames);
// The poses, after look_up(), with the model's links.
void place_chain(const ArmModel& model, const FixedLinks& links, std::size_t link,
                 ChainFrames& frames);
// All of it.
void evaluate_chain(const ArmModel& model, const JointVector& readings, std::size_t link,
                    ChainFrames& frames);

}  // namespace armsig::calibration
