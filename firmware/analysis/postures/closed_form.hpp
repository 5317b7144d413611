// SPDX-License-Identifier: MIT
// Closed forms of the two common six-joint designs, as starting points for the identified chain.
//
// The design is read off the chain itself: its twists are snapped to quarter turns and its small
// offsets dropped. What the closed form then misses (millimetres) Newton makes up for.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics {

enum class Design : std::uint8_t {
  kSphericalWrist,  // shoulder and elbow axes parallel, last three axes through one point (Puma)
  kParallelAxes,    // axes 2, 3, 4 parallel (UR)
  kOther,
};

// Which of the eight solutions, with the names of VAL II.
struct Posture {
  bool lefty = false;  // the upper arm is to the left of the line from the base axis to the wrist
  bool above = false;  // the elbow is above the line from the shoulder to the wrist
  bool flip = false;   // the angle of joint 5 is negative

  bool operator==(const Posture&) const = default;
};

// Lengths in metres, angles in radians; signs are those of quarter turns, +1 or -1.
struct ClosedForm {
  Design design = Design::kOther;
  std::array<double, 6> theta{};  // offsets from reading to angle
  double a1 = 0;
  double d1 = 0;
  double a2 = 0;
  double forearm = 0;  // from the elbow to the wrist point, or to axis 4 where axes are parallel
  double forearm_angle = 0;    // in the plane of the arm, before joint 3 turns it
  double shoulder_offset = 0;  // along the parallel axes, all links together
  double a4 = 0;               // parallel axes: links beyond axis 4
  double d5 = 0;
  double sign1 = 1;  // of alpha_1
  double sign3 = 1;  // spherical wrist only
  double sign4 = 1;
  double sign5 = 1;
  double fold2 = 1;  // cos alpha_2, +1 or -1
  Pose X_6n;         // from the turned joint 6 to frame n
};

// The closed form nearest to `chain`; design kOther where there is none.
[[nodiscard]] ClosedForm closed_form(const Chain& chain);

struct Start {
  JointVector q;  // radians in (-pi, pi]
  // Out of reach of the idealised arm by more than it differs from the chain.
  bool reachable = true;
  bool near_fold = false;  // some opening is next to zero
};

// Readings that bring the idealised arm to X_0n in the posture asked for. Design must not be
// kOther.
[[nodiscard]] Start solve_closed_form(const ClosedForm& form, const Pose& X_0n,
                                      const Posture& posture);

// The posture of readings q. Design must not be kOther.
[[nodiscard]] Posture posture_of(const ClosedForm& form, const JointVector& q);

}  // namespace armsig::kinematics
