// SPDX-License-Identifier: MIT
// What gravity does to the joints in the servo tick, and the lever that bounds it.
#include "core/calibration/servo_gravity.hpp"

#include <memory>
#include <random>

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::kP;
using test::kR;

ServoGravity gravity_of(const Arm& drawing, const std::vector<GravityTerm>& terms) {
  PackedDeflections deflections = packed(model_of(drawing, {}));
  EXPECT_EQ(deflections.up_0, drawing.up_0);
  for (const GravityTerm& term : terms) deflections.gravity.push_back(term);
  ServoGravity gravity;
  gravity.set(deflections, drawing);
  return gravity;
}

TEST(ServoGravity, has_the_links_laid_end_to_end_as_its_longest_lever) {
  const Arm arm =
      test::make_arm({{kR, 0, 0.4, 0.3, kPi / 2}, {kP, 0.1, 0.12, 0.05, 0}, {kR, 0, 0, 0.25, 0}},
                     {{-3, 3}, {-0.2, 0.7}, {-3, 3}});
  EXPECT_NEAR(gravity_of(arm, {}).lever_m(), 0.5 + 0.13 + 0.7 + 0.25, 1e-15);
  Arm pulled = arm;
  pulled.limits[1] = {-0.9, 0.1};
  EXPECT_NEAR(gravity_of(pulled, {}).lever_m(), 0.5 + 0.13 + 0.9 + 0.25, 1e-15);
}

TEST(ServoGravity, has_no_lever_longer_than_any_arm) {
  const Arm arm = test::make_arm({{kR, 0, 0, 30, 0}, {kR, 0, 0, 30, 0}}, {{-3, 3}, {-3, 3}});
  EXPECT_EQ(gravity_of(arm, {}).lever_m(), 10);
}

// Axes 30 degrees off the horizontal, and then upright: gravity pulls at the first along 1/2.
TEST(ServoGravity, pulls_at_slides_along_the_vertical_wherever_they_are) {
  const Arm arm = test::make_arm(
      {{kP, 0, 0, 0, radians(60)}, {kP, 0.3, 0, 0.1, radians(-60)}, {kP, 0, 0, 0.1, 0}},
      {{-1, 1}, {-1, 1}, {-1, 1}});
  const ServoGravity gravity = gravity_of(arm, {{.joint = 1, .origin = 3, .coefficient = 1e-3},
                                                {.joint = 2, .origin = 3, .coefficient = 2e-3}});
  // Of joint 2, z by the product of the rotations, here written out for any reading.
  const double sixty = radians(60);
  const double z =
      std::cos(sixty) * std::cos(sixty) + std::sin(sixty) * std::cos(0.3) * std::sin(sixty);
  for (const double reading : {-0.8, 0.0, 0.5}) {
    ServoGravity::Values q{};
    q.fill(reading);
    ServoGravity::Values by;
    gravity.at(q, by);
    EXPECT_EQ(by[0], 0);
    EXPECT_NEAR(by[1], -1e-3 * std::cos(sixty), 1e-15) << reading;
    EXPECT_NEAR(by[2], -2e-3 * z, 1e-15) << reading;
  }
}

// What gravity does to each joint by the definition: the torque about its axis of a weight at each
// origin, or the force along it, from products of 4 x 4 matrices.
std::vector<double> by_torques(const Arm& arm, const std::vector<GravityTerm>& terms,
                               const ServoGravity::Values& q) {
  std::vector<Eigen::Matrix4d> T{Eigen::Matrix4d::Identity()};
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    const bool turns = row.type == kR;
    const double t = row.theta_rad + (turns ? q[i] : 0);
    const double d = row.d_m + (turns ? 0 : q[i]);
    const double ca = std::cos(row.alpha_rad);
    const double sa = std::sin(row.alpha_rad);
    Eigen::Matrix4d A;
    A << std::cos(t), -std::sin(t) * ca, std::sin(t) * sa, row.a_m * std::cos(t),  //
        std::sin(t), std::cos(t) * ca, -std::cos(t) * sa, row.a_m * std::sin(t),   //
        0, sa, ca, d,                                                              //
        0, 0, 0, 1;
    T.push_back(T.back() * A);
  }
  std::vector<double> by(arm.joints.size(), 0.0);
  for (const GravityTerm& term : terms) {
    const Vector3 z = T[term.joint].block<3, 1>(0, 2);
    const Vector3 r = T[term.origin].block<3, 1>(0, 3) - T[term.joint].block<3, 1>(0, 3);
    const Vector3 weight = -arm.up_0;
    by[term.joint] += term.coefficient *
                      (arm.joints[term.joint].type == kR ? z.dot(r.cross(weight)) : z.dot(weight));
  }
  return by;
}

// On the floor, the ceiling, both walls, and at random angles; every joint has a term.
TEST(ServoGravity, pulls_along_the_vertical_however_the_arm_stands) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> any(-3, 3);
  Arm arm = test::make_arm({{kR, 0.2, 0.4, 0.1, radians(80)},
                            {kP, 0.3, 0, 0.2, radians(-70)},
                            {kR, -0.4, 0.1, 0.3, radians(20)},
                            {kR, 0.1, 0.2, 0, radians(90)},
                            {kR, 0, 0.1, 0.05, 0}},
                           {{-3, 3}, {-1, 1}, {-3, 3}, {-3, 3}, {-3, 3}});
  std::vector<GravityTerm> terms;
  for (std::uint8_t joint = 0; joint < 5; ++joint) {
    for (std::uint8_t origin = joint + 1; origin <= 5; ++origin) {
      terms.push_back({.joint = joint, .origin = origin, .coefficient = 1e-3 * any(random)});
    }
  }
  std::vector<Vector3> ups{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, -1, 0}, {1e-9, 0, 1}};
  for (int k = 0; k < 20; ++k) {
    ups.push_back(Vector3(any(random), any(random), any(random)).normalized());
  }
  for (const Vector3& up : ups) {
    arm.up_0 = up;
    const ServoGravity gravity = gravity_of(arm, terms);
    ArmModel model = model_of(arm, {});
    for (const GravityTerm& term : terms) model.gravity.push_back(term);
    for (int k = 0; k < 10; ++k) {
      ServoGravity::Values q{};
      JointVector readings;
      for (std::size_t i = 0; i < 5; ++i) readings.push_back(q[i] = any(random));
      ServoGravity::Values by;
      gravity.at(q, by);
      const std::vector<double> expected = by_torques(arm, terms, q);
      GravityLevers levers;
      gravity_levers(model, readings, levers);
      std::vector<double> by_levers(5, 0.0);
      for (std::size_t t = 0; t < terms.size(); ++t) {
        by_levers[terms[t].joint] += terms[t].coefficient * levers[t];
      }
      for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(by[i], expected[i], 1e-15) << "joint " << i + 1 << ", up " << up.transpose();
        EXPECT_NEAR(by_levers[i], expected[i], 1e-15) << i;
        EXPECT_LE(std::abs(by[i]), gravity.largest());
      }
    }
  }
}

// One object, set for one arm and then for another that stands otherwise.
TEST(ServoGravity, remembers_nothing_of_how_another_arm_stood) {
  const GravityTerm term{.joint = 1, .origin = 3, .coefficient = 1e-3};
  Arm arm = test::make_arm({{kR, 0, 0.4, 0.1, kPi / 2}, {kR, 0, 0, 0.3, 0}, {kR, 0, 0, 0.25, 0}},
                           {{-3, 3}, {-3, 3}, {-3, 3}});
  const ServoGravity upright = gravity_of(arm, {term});
  arm.up_0 = Vector3::UnitX();
  ServoGravity both = gravity_of(arm, {term});
  arm.up_0 = Vector3::UnitZ();
  PackedDeflections deflections = packed(model_of(arm, {}));
  deflections.gravity.push_back(term);
  both.set(deflections, arm);
  ServoGravity::Values q{0.3, -0.5, 0.7};
  ServoGravity::Values by;
  ServoGravity::Values expected;
  both.at(q, by);
  upright.at(q, expected);
  EXPECT_EQ(by, expected);
  EXPECT_NE(by[1], 0);
}

}  // namespace
}  // namespace armsig::calibration
