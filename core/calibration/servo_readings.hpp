// SPDX-License-Identifier: MIT
// Gravity and joint error maps in the servo tick: from readings to how far the joints have
// turned, and back, in bounded work.
//
// turned(q) = q + d(q) - d(q of the signature configuration), d_i = map_i(encoder reading i) + the
// sum of coefficient times lever over its gravity terms (docs/model.md, section 7). All q are
// effective readings; the encoders' are taken from them where joints are coupled.
#pragma once

#include "core/calibration/servo_gravity.hpp"
#include "core/calibration/servo_maps.hpp"

namespace armsig::calibration {

// What the last inverse found, for the next one near it to begin with: one pass over the arm's
// gravity is then enough. At first, and after any jump, it costs a few more.
struct LatelyTurned {
  std::array<double, kMaxJoints> by{};              // turned less reading
  std::array<double, kMaxJoints> gravity{};         // gravity's part of it
  std::array<double, kMaxJoints> gravity_before{};  // in the inverse before
};

class ServoReadings {
 public:
  // Of an arm that its readings say everything of.
  ServoReadings() = default;
  // `drawing`: whose rows the levers are taken from. `configuration`: effective readings at which
  // the joints have turned as the readings say. Preconditions: check() accepts `deflections`, of as
  // many joints as the drawing.
  ServoReadings(const PackedDeflections& deflections, const Arm& drawing,
                const JointVector& configuration) {
    set(deflections, drawing, configuration);
  }
  // The same in place, as all of it is large for a small stack: as if it had just been made.
  void set_exact();
  void set(const PackedDeflections& deflections, const Arm& drawing,
           const JointVector& configuration);

  [[nodiscard]] bool exact() const { return joint_count_ == 0; }

  // How far the joints have turned. Errors: kNotFinite.
  [[nodiscard]] Result<JointVector> turned(const JointVector& q) const;

  // The readings at which they have: Newton's method with the slopes of the maps, gravity by
  // substitution. turned() of what it returns is `turned` within 1e-10 m at the longest lever.
  // Errors: kNotFinite; kNotConverged (not seen of deflections that check() accepts).
  [[nodiscard]] Result<JointVector> readings(const JointVector& turned) const;
  [[nodiscard]] Result<JointVector> readings(const JointVector& turned, LatelyTurned& lately) const;

  // Largest number [rad or m] that turned() may differ from its argument by.
  [[nodiscard]] double largest() const { return largest_; }

  // The joint limits of the drawing, which are those of the readings, and what the joints may turn
  // for readings inside of them: the limits of a chain for inverse() of servo_inverse.hpp.
  [[nodiscard]] const FixedVector<JointLimits, kMaxJoints>& limits() const { return limits_; }
  [[nodiscard]] FixedVector<JointLimits, kMaxJoints> turned_limits() const;

 private:
  using Values = std::array<double, kMaxJoints>;

  // What the encoders read: q itself, or `coupled`.
  [[nodiscard]] const Values& encoders(const Values& q, Values& coupled) const;
  [[nodiscard]] Values filled(const JointVector& q) const;
  [[nodiscard]] bool deflections_at(const Values& readings, Values& by) const;
  Result<void> undo_maps(const Values& wanted, Values& q, Values& gain) const;

  std::size_t joint_count_ = 0;
  ServoMaps maps_;
  // The inverse has ended where the squares of these times the joints' last steps have no larger
  // sum than one: for the maps alone, and for gravity.
  alignas(32) Values map_weight_{};
  alignas(32) Values weight_{};
  ServoGravity gravity_;
  JointCouplings couplings_;
  FixedVector<JointLimits, kMaxJoints> limits_;
  alignas(32) Values rest_deflection_{};  // at the signature configuration
  double largest_ = 0;
};

}  // namespace armsig::calibration
