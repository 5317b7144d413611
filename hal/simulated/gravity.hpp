// SPDX-License-Identifier: MIT
// How gravity pulls at the joints of an arm, by the geometry of its links and by its pose.
//
// Each link is a uniform rod between the origins of its two Denavit-Hartenberg frames, with the
// motor of the next joint at its far end and the load on the last. The torque of a joint is the
// weight of what it carries along the motion of its centres of mass; it accelerates those masses
// along that motion, and its own rotor (the other joints hold by theirs).
#pragma once

#include "core/base/fixed_vector.hpp"
#include "hal/simulated/arm.hpp"

namespace armsig::simulated {

// The defaults are of a small arm. Rotors are of the order that Armstrong, Khatib and Burdick
// measured at a Puma 560 (ICRA 1986): 0.2 kg m^2 at the wrist to 4.7 at the shoulder.
struct Limbs {
  double kg_per_m = 8;          // of each rod
  double motor_kg = 2;          // at the end of each link
  double load_kg = 2;           // at the target on the last link, else at its frame
  double rotor_kg_m2 = 1;       // of a revolute joint, seen through its gear
  double rotor_kg = 50;         // of a prismatic joint
  Vector3 g_S{0, 0, -9.80665};  // m/s^2, in the sensor frame
};

// rad/s^2 or m/s^2 of each reading where nothing holds the joint but the others are held.
[[nodiscard]] JointVector gravity_pull(const SimulatedArm& arm, const JointVector& readings,
                                       const Limbs& limbs = {});

}  // namespace armsig::simulated
