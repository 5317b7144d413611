// SPDX-License-Identifier: MIT
// Gravity and maps of the readings in the servo tick: from readings to how far the joints have
// turned, and back, in bounded work.
//
// turned(q) = q + d(q) - d(q of the signature configuration), d_i = map_i(encoder reading i) + the
// sum of coefficient times lever over its gravity terms (section 8 of ALGORITHMS). All q are
// effective readings; the encoders' are taken from them where joints are coupled.
#pragma once

#include "core/calibration/packed_deflections.hpp"
#include "core/kinematics/inverse.hpp"

namespace armsig::calibration {

class ServoReadings {
 public:
  // Of an arm that its readings say everything of.
  ServoReadings() = default;
  // `drawing`: whose rows the levers are taken from. `configuration`: effective readings at which
  // the joints have turned as the readings say. Preconditions: check() accepts `deflections`, of as
  // many joints as the drawing.
  ServoReadings(const PackedDeflections& deflections, const Arm& drawing,
                const JointVector& configuration);

  [[nodiscard]] bool exact() const { return joint_count_ == 0; }

  // How far the joints have turned. Errors: kNotFinite.
  [[nodiscard]] Result<JointVector> turned(const JointVector& q) const;

  // The readings at which they have: Newton's method with the slopes of the maps, gravity by
  // substitution. turned() of what it returns is `turned` within 1e-9 rad or m.
  // Errors: kNotFinite; kNotConverged (not seen of deflections that check() accepts).
  [[nodiscard]] Result<JointVector> readings(const JointVector& turned) const;

  // Largest number [rad or m] that turned() may differ from its argument by.
  [[nodiscard]] double largest() const { return largest_; }

  // The joint limits of the drawing, which are those of the readings, and what the joints may turn
  // for readings inside of them: the limits of a chain for inverse(), below.
  [[nodiscard]] const FixedVector<JointLimits, kMaxJoints>& limits() const { return limits_; }
  [[nodiscard]] FixedVector<JointLimits, kMaxJoints> turned_limits() const;

 private:
  struct Map {
    double origin = 0;
    double turns_per_length = 0;  // whole periods
    double knots_per_length = 0;
    double sixth = 0;  // of a step, rad or m
    double sixth_by_length = 0;
    std::array<std::int16_t, kKnots + kSplines> steps{};  // the first ones once more at the end
  };
  using Values = std::array<double, kMaxJoints>;
  struct Work;  // what deflections are made of

  [[nodiscard]] bool has_gravity() const { return !gravity_.empty() || !slide_gravity_.empty(); }
  void find_cubics(const JointVector& q, Work& work) const;
  [[nodiscard]] bool begin(const JointVector& q, Work& work) const;
  [[nodiscard]] bool move(const JointVector& q, const Values& moved, Work& work) const;
  void deflections(const Work& work, Values& by) const;
  void add_gravity(const Work& work, Values& by) const;
  void add_slides(const Work& work, Values& by) const;

  std::size_t joint_count_ = 0;
  std::array<Map, kMaxJoints> maps_{};
  JointCouplings couplings_;
  kinematics::Chain drawing_;  // its frames where Denavit and Hartenberg put them
  FixedVector<GravityTerm, kMaxGravityTerms> gravity_;  // of joints that turn
  FixedVector<GravityTerm, kMaxGravityTerms> slide_gravity_;
  FixedVector<JointLimits, kMaxJoints> limits_;
  Values at_rest_{};
  double largest_ = 0;
  double left_ = 0;  // by readings(): rad or m
};

// kinematics::inverse() of an arm whose joints turn as `joints` says: readings, near the readings
// `seed`, at which frame n of `chain` is at X_0n. `chain` has joints.turned_limits(), or none.
// Errors: those of kinematics::inverse() and ServoReadings::readings().
[[nodiscard]] Result<kinematics::InverseSolution> inverse(
    const kinematics::Chain& chain, const ServoReadings& joints, const Pose& X_0n,
    const JointVector& seed, const kinematics::InverseOptions& options = {});

}  // namespace armsig::calibration
