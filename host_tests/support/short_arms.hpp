// SPDX-License-Identifier: MIT
// Arms of three to five joints, as drawn and as individuals: their axes are a little out of
// parallel, so that they meet no orientation exactly which they did not take.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "core/base/links.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::test {

struct ShortArm {
  KnownArm arm;
  Vector3 p_nT;    // the tool
  JointVector at;  // well inside of what the arm reaches
  Vector3 way;     // of a line from there, in frame 0
};

inline KnownArm first_joints(KnownArm arm, std::size_t joints) {
  arm.name += " of " + std::to_string(joints) + " joints";
  arm.drawing.joints.resize(joints);
  arm.drawing.limits.resize(joints);
  arm.drawing.couplings.clear();
  return drawn(arm.name, arm.drawing);
}

// Three slides and a hand that turns.
inline KnownArm gantry() {
  const auto slide = [](double theta_rad, double alpha_rad) {
    return DhJoint{JointType::kPrismatic, theta_rad, 0, 0, alpha_rad};
  };
  Arm arm;
  arm.joints = {slide(0, -kPi / 2), slide(-kPi / 2, -kPi / 2), slide(0, 0),
                DhJoint{JointType::kRevolute, 0, 0, 0, 0}};
  arm.limits = {{0, 2}, {0, 1}, {0, 0.5}, {-kPi, kPi}};
  return drawn("gantry", arm);
}

inline std::vector<ShortArm> short_arms() {
  const KnownArm palletizer = shared("../cases/palletizer/arm");
  const KnownArm five = shared("../cases/kinematics/five_axes");
  const auto deg = [](auto... angles) { return JointVector{radians(angles)...}; };
  return {
      {cobra600(), {0.06, 0, 0.08}, {0.2, radians(60), 0.1, 0.3}, {0.05, -0.03, 0.01}},
      {palletizer, {0.1, 0, 0.2}, deg(10, -70, 60, 10, 20), {0.15, 0.1, -0.2}},
      {five, {0.05, 0.02, 0.1}, deg(10, 20, -60, 30, 40), {0.03, 0.05, -0.04}},
      {first_joints(palletizer, 4), {0.05, 0, 0.1}, deg(10, -70, 60, 10), {0.15, 0.1, -0.2}},
      {first_joints(five, 3), {0.05, 0.02, 0.1}, deg(10, 20, -60), {0.03, 0.05, -0.04}},
      {gantry(), {0.1, 0, 0.1}, {1, 0.5, 0.2, 0.4}, {0.1, -0.15, 0.05}},
      {first_joints(gantry(), 3), {0.1, 0, 0.1}, {1, 0.5, 0.2}, {0.1, -0.15, 0.05}},
  };
}

// As built: angles 0.2 degrees off, lengths 0.5 mm, 1 sigma each.
inline KnownArm individual(KnownArm arm, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  for (DhJoint& row : arm.joints) {
    row.theta_rad += radians(0.2) * normal(random);
    row.alpha_rad += radians(0.2) * normal(random);
    row.a_m += 5e-4 * normal(random);
    row.d_m += 5e-4 * normal(random);
  }
  arm.name += ", an individual";
  return arm;
}

}  // namespace armsig::test
