// SPDX-License-Identifier: MIT
// Kinds of six-axis arms, and of the poses in which they stand, for judging a search of postures.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "host_tests/support/pose_trials.hpp"

namespace armsig::test {

// One kind: how an arm is drawn, and how it stands.
struct PostureKind {
  std::string name;
  std::function<KnownArm(std::mt19937_64&)> arm;
  std::function<JointVector(const KnownArm&, std::mt19937_64&)> stand;
};

inline KnownArm arm_of(const std::string& name, const DhRows& rows) {
  KnownArm arm;
  arm.name = name;
  arm.joints = rows;
  for (const DhJoint& row : rows) {
    arm.limits.push_back(row.type == JointType::kRevolute ? JointLimits{-kPi, kPi}
                                                          : JointLimits{0, 0.5});
  }
  return arm;
}

// Rows as short as they are written here: theta, d, a, alpha.
inline DhRows rows_of(std::initializer_list<std::array<double, 4>> rows) {
  DhRows all;
  for (const auto& [theta, d, a, alpha] : rows) all.push_back({kR, theta, d, a, alpha});
  return all;
}

inline constexpr double kQuarter = kPi / 2;

inline KnownArm puma_like() {
  return arm_of("spherical wrist", rows_of({{0, 0.4, 0.025, -kQuarter},
                                            {0, 0, 0.455, 0},
                                            {-kQuarter, 0, 0.035, -kQuarter},
                                            {0, -0.42, 0, kQuarter},
                                            {0, 0, 0, -kQuarter},
                                            {0, -0.08, 0, kPi}}));
}
inline KnownArm ur_like() {
  return arm_of("three parallel axes", rows_of({{0, 0.0892, 0, kQuarter},
                                                {0, 0, -0.425, 0},
                                                {0, 0, -0.3923, 0},
                                                {0, 0.1092, 0, kQuarter},
                                                {0, 0.0947, 0, -kQuarter},
                                                {0, 0.0823, 0, 0}}));
}
inline KnownArm table_top() {
  return arm_of("table-top arm", rows_of({{kQuarter, 0.13, 0, 1.5708},
                                          {kQuarter, 0, 0.11, 0},
                                          {0, 0.065, 0.095, 0},
                                          {kQuarter, 0, 0, 1.5708},
                                          {-kQuarter, 0.074, 0, 1.5708},
                                          {0, 0.046, 0, 0}}));
}
// As the CRX-10iA.
inline KnownArm offset_cobot() {
  return arm_of("offset between axes 5 and 6, 145 mm", rows_of({{0, 0, 0, -kQuarter},
                                                                {-kQuarter, 0, 0.7, kPi},
                                                                {0, 0, 0, -kQuarter},
                                                                {0, -0.54, 0, kQuarter},
                                                                {0, 0.15, 0, -kQuarter},
                                                                {0, -0.16, 0, kPi}}));
}
// As the CRB 15000.
inline KnownArm bent_cobot() {
  return arm_of("wrist with 80 mm across", rows_of({{0, 0.265, 0, -kQuarter},
                                                    {-kQuarter, 0, 0.444, 0},
                                                    {0, 0, 0.11, -kQuarter},
                                                    {0, 0.47, 0, kQuarter},
                                                    {0, 0, 0.08, -kQuarter},
                                                    {0, 0.101, 0, 0}}));
}
// As the Jaco with its wrist at sixty degrees.
inline KnownArm slanted_wrist() {
  return arm_of("wrist at sixty degrees", rows_of({{0, 0.2755, 0, kQuarter},
                                                   {0, 0, 0.41, kPi},
                                                   {0, -0.0098, 0, kQuarter},
                                                   {0, -0.2501, 0, kPi / 3},
                                                   {0, -0.0856, 0, kPi / 3},
                                                   {0, -0.2028, 0, kPi}}));
}
// As the Gen3 lite.
inline KnownArm light_arm() {
  return arm_of("offset wrist of a light arm", rows_of({{0, 0.2433, 0, kQuarter},
                                                        {kQuarter, 0.03, 0.28, kPi},
                                                        {kQuarter, 0.02, 0, kQuarter},
                                                        {kQuarter, 0.245, 0, kQuarter},
                                                        {kPi, 0.057, 0, kQuarter},
                                                        {kQuarter, 0.235, 0, 0}}));
}

// As it is built: to a tenth of a degree and half a millimetre.
inline KnownArm built(KnownArm arm, std::mt19937_64& random) {
  for (DhJoint& row : arm.joints) {
    row.theta_rad += uniform(random, -3e-3, 3e-3);
    row.d_m += uniform(random, -5e-4, 5e-4);
    row.a_m += uniform(random, -5e-4, 5e-4);
    row.alpha_rad += uniform(random, -2e-3, 2e-3);
  }
  return arm;
}

// Lengths and twists of any kind.
inline KnownArm any_arm(std::mt19937_64& random) {
  DhRows rows;
  for (int i = 0; i < 6; ++i) {
    rows.push_back({kR, uniform(random, -kPi, kPi), uniform(random, -0.4, 0.4),
                    uniform(random, -0.5, 0.5), uniform(random, -kPi, kPi)});
  }
  return arm_of("any axes", rows);
}

// Twists of quarter turns, and half of the lengths none, as people build them.
inline KnownArm square_arm(std::mt19937_64& random) {
  const auto length = [&](double most) {
    return random() % 2 == 0 ? 0.0 : uniform(random, -most, most);
  };
  while (true) {
    DhRows rows;
    int parallel = 0;
    for (int i = 0; i < 6; ++i) {
      const bool is_parallel = i < 5 && parallel < 2 && random() % 3 == 0;
      parallel += is_parallel ? 1 : 0;
      rows.push_back({kR, 0, length(0.4), is_parallel ? uniform(random, 0.2, 0.5) : length(0.5),
                      is_parallel ? 0 : (random() % 2 == 0 ? kQuarter : -kQuarter)});
    }
    KnownArm arm = arm_of("square twists", rows);
    const kinematics::Chain chain = kinematics::make_chain(rows);
    int regular = 0;
    for (int k = 0; k < 5; ++k) {
      regular += std::abs(jacobian_determinant(chain, random_readings(arm, random))) > 1e-5 ? 1 : 0;
    }
    if (regular >= 3) return arm;
  }
}

// Axes 2 and 3 parallel and axes 4 and 5 meeting, all other lengths any.
inline KnownArm offset_wrist_arm(std::mt19937_64& random) {
  const auto length = [&](double most) {
    return random() % 2 == 0 ? 0.0 : uniform(random, -most, most);
  };
  return arm_of("any offset wrist", rows_of({{0, 0.3, length(0.2), kQuarter},
                                             {0, length(0.2), uniform(random, 0.2, 0.6), 0},
                                             {0, length(0.2), length(0.2), kQuarter},
                                             {0, uniform(random, 0.2, 0.5), 0, -kQuarter},
                                             {0, length(0.2), length(0.2), kQuarter},
                                             {0, 0.1, length(0.1), 0}}));
}

inline JointVector anywhere(const KnownArm& arm, std::mt19937_64& random) {
  return random_readings(arm, random);
}

// Reading `joint` (0: the first) at its angle `at`, within 10^least to 10^most.
inline auto near_angle(std::size_t joint, double at, double least, double most) {
  return [=](const KnownArm& arm, std::mt19937_64& random) {
    JointVector q = random_readings(arm, random);
    const double by = std::pow(10, uniform(random, least, most)) * (random() % 2 == 0 ? 1 : -1);
    const kinematics::Chain chain = kinematics::make_chain(arm.joints);
    q[joint] = at - chain.theta[joint] + by;
    return q;
  };
}

// Where the determinant of the Jacobian is zero, found along one of the joints.
inline JointVector on_fold(const KnownArm& arm, std::mt19937_64& random) {
  const kinematics::Chain chain = kinematics::make_chain(arm.joints);
  for (int k = 0; k < 100; ++k) {
    const std::size_t joint = kSingularJoints[random() % kSingularJoints.size()];
    const auto q = made_singular(arm, chain, random_readings(arm, random), joint, random);
    if (q) return *q;
  }
  return random_readings(arm, random);
}

// The wrist's point on axis 1, found along joint 2.
inline JointVector over_axis_1(const KnownArm& arm, std::mt19937_64& random) {
  const kinematics::Chain chain = kinematics::make_chain(arm.joints);
  for (int k = 0; k < 100; ++k) {
    const auto q = made_singular(arm, chain, random_readings(arm, random), 1, random);
    if (q) return *q;
  }
  return random_readings(arm, random);
}

inline JointVector off_fold(const KnownArm& arm, std::mt19937_64& random) {
  JointVector q = on_fold(arm, random);
  const double by = std::pow(10, uniform(random, -6, -2));
  for (double& reading : q) reading += uniform(random, -by, by);
  return q;
}

}  // namespace armsig::test
