// SPDX-License-Identifier: MIT
// Gravity by the links' geometry, against levers worked out by hand and against the potential
// energy.
#include "hal/simulated/gravity.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace armsig::simulated {
namespace {

constexpr double kG = 9.80665;

// A metre of rod that turns about a level axis, a load on its end.
SimulatedArm beam() {
  SimulatedArm arm;
  arm.arm.joints.push_back({.a_m = 1.0});
  arm.X_S0 = {rotation_x(radians(90)), Vector3::Zero()};
  return arm;
}

TEST(Gravity, pulls_a_beam_by_its_lever) {
  // 8 kg of rod at half a metre and 2 kg at a metre, over 8/4 + 2 + 1 kg m^2.
  const double level = (8 * 0.5 + 2 * 1.0) * kG / (8 * 0.25 + 2 + 1);
  EXPECT_NEAR(gravity_pull(beam(), {0.0})[0], -level, 1e-9);
  EXPECT_NEAR(gravity_pull(beam(), {radians(60)})[0], -0.5 * level, 1e-9);
  EXPECT_NEAR(gravity_pull(beam(), {radians(180)})[0], level, 1e-9);
  EXPECT_NEAR(gravity_pull(beam(), {radians(-90)})[0], 0, 1e-9);
}

TEST(Gravity, pulls_a_slide_along_its_axis) {
  SimulatedArm arm;
  arm.arm.joints.push_back({.type = JointType::kPrismatic});
  EXPECT_NEAR(gravity_pull(arm, {0.5})[0], -(8 * 0.5 + 2) * kG / (8 * 0.5 + 2 + 50), 1e-9);
}

// An arm with a coupling, at some pose: the work of gravity is what the potential energy loses.
TEST(Gravity, does_the_work_that_the_masses_lose_in_height) {
  SimulatedArm arm;
  arm.arm.joints = {{.alpha_rad = radians(-90)},
                    {.d_m = 0.15, .a_m = 0.43},
                    {.type = JointType::kPrismatic, .alpha_rad = radians(20)},
                    {.a_m = 0.3, .alpha_rad = radians(90)}};
  arm.arm.couplings = {{.joint = 3, .from = 1, .ratio = -0.4}};
  arm.X_S0 = {rotation_x(radians(40)) * rotation_z(radians(10)), Vector3(0.1, 0.2, 0.3)};
  arm.targets.push_back({1, 4, Vector3(0.1, 0.05, 0.2)});
  const JointVector q{0.3, -0.7, 0.4, 1.1};
  const Limbs limbs;
  constexpr double kStep = 1e-5;
  const JointVector pull = gravity_pull(arm, q);
  for (std::size_t i = 0; i < 4; ++i) {
    JointVector above = q;
    JointVector below = q;
    above[i] += kStep;
    below[i] -= kStep;
    double work = 0;
    double inertia = i == 2 ? limbs.rotor_kg : limbs.rotor_kg_m2;
    const auto carry = [&](double kg, const Vector3& p_S, std::size_t link) {
      const Vector3 p_L = link_pose(arm, q, link).inverse() * p_S;  // the mass is fixed to its link
      const Vector3 by_reading =
          (link_pose(arm, above, link) * p_L - link_pose(arm, below, link) * p_L) / (2 * kStep);
      work -= kg * kG * by_reading.z();
      inertia += kg * by_reading.squaredNorm();
    };
    for (std::size_t link = 1; link <= 4; ++link) {
      const Vector3 near = link_pose(arm, q, link - 1).p;
      const Vector3 far = link_pose(arm, q, link).p;
      carry(limbs.kg_per_m * (far - near).norm(), 0.5 * (near + far), link);
      if (link < 4) carry(limbs.motor_kg, far, link);
    }
    carry(limbs.load_kg, target_position(arm, q, arm.targets[0]), 4);
    EXPECT_NEAR(pull[i], work / inertia, 1e-6) << i;
  }
}

}  // namespace
}  // namespace armsig::simulated
