// SPDX-License-Identifier: MIT
// The published arms that the tests use, as standard Denavit-Hartenberg rows; the same numbers as
// the arm descriptions in the shared data folder (arms/*.yaml), which name their sources.
#pragma once

#include <array>
#include <initializer_list>
#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::testing {

inline constexpr JointType kR = JointType::kRevolute;
inline constexpr JointType kP = JointType::kPrismatic;

inline DhJoint row_mm_deg(JointType type, double theta_deg, double d_mm, double a_mm,
                          double alpha_deg) {
  return {type, radians(theta_deg), d_mm * 1e-3, a_mm * 1e-3, radians(alpha_deg)};
}

inline Arm arm_of(std::initializer_list<DhJoint> rows) {
  Arm arm;
  for (const DhJoint& row : rows) {
    arm.joints.push_back(row);
    arm.limits.push_back(row.type == kR ? JointLimits{-kPi, kPi} : JointLimits{0.0, 0.5});
  }
  return arm;
}

// Stone, Sanderson, Neuman 1986, Table 1.
inline Arm puma560() {
  return arm_of({row_mm_deg(kR, 0, 0, 0, -90), row_mm_deg(kR, 0, 149.09, 431.8, 0),
                 row_mm_deg(kR, 0, 0, -20.32, 90), row_mm_deg(kR, 0, 430.7, 0, -90),
                 row_mm_deg(kR, 0, 0, 0, 90), row_mm_deg(kR, 0, 0, 0, 0)});
}

// Table 2, robot 1.
inline Arm puma560_robot1() {
  return arm_of({row_mm_deg(kR, 110.308, -206.78, -0.05, -90.066),
                 row_mm_deg(kR, 79.977, 112102.13, 76.07, -0.217),
                 row_mm_deg(kR, -79.483, -111949.78, -20.39, 90.519),
                 row_mm_deg(kR, -0.296, 432.78, -0.01, -90.007),
                 row_mm_deg(kR, -0.497, -0.18, 0.02, 89.99), row_mm_deg(kR, -89.081, 103, 0, 0)});
}

// Table 2, robot 2.
inline Arm puma560_robot2() {
  return arm_of({row_mm_deg(kR, 110.849, -204.28, -0.23, -90.013),
                 row_mm_deg(kR, 63.467, 27835.8, 190.84, -0.803),
                 row_mm_deg(kR, -63.276, -27685.74, -20.28, 90.134),
                 row_mm_deg(kR, 0.328, 432.99, -0.09, -89.991),
                 row_mm_deg(kR, -0.126, -0.54, 0.07, 89.969),
                 row_mm_deg(kR, -89.517, 102.73, 0, 0)});
}

// Prismatic third joint; parameters as in the Robotics Toolbox.
inline Arm stanford() {
  return arm_of({row_mm_deg(kR, 0, 412, 0, -90), row_mm_deg(kR, 0, 154, 0, 90),
                 row_mm_deg(kP, -90, 0, 20.3, 0), row_mm_deg(kR, 0, 0, 0, -90),
                 row_mm_deg(kR, 0, 0, 0, 90), row_mm_deg(kR, 0, 0, 0, 0)});
}

// SCARA: all axes parallel; parameters as in the Robotics Toolbox.
inline Arm cobra600() {
  return arm_of({row_mm_deg(kR, 0, 387, 325, 0), row_mm_deg(kR, 0, 0, 275, 180),
                 row_mm_deg(kP, 0, 0, 0, 0), row_mm_deg(kR, 0, 0, 0, 0)});
}

// KUKA LBR iiwa 7: seven joints.
inline Arm iiwa7() {
  return arm_of({row_mm_deg(kR, 0, 340, 0, -90), row_mm_deg(kR, 0, 0, 0, 90),
                 row_mm_deg(kR, 0, 400, 0, 90), row_mm_deg(kR, 0, 0, 0, -90),
                 row_mm_deg(kR, 0, 400, 0, -90), row_mm_deg(kR, 0, 0, 0, 90),
                 row_mm_deg(kR, 0, 126, 0, 0)});
}

// Nominal parameters published by the maker.
inline Arm ur5() {
  return arm_of({{kR, 0, 0.089159, 0, 1.570796327},
                 {kR, 0, 0, -0.425, 0},
                 {kR, 0, 0, -0.39225, 0},
                 {kR, 0, 0.10915, 0, 1.570796327},
                 {kR, 0, 0.09465, 0, -1.570796327},
                 {kR, 0, 0.0823, 0, 0}});
}

// Nominal parameters published by the maker.
inline Arm ur10e() {
  return arm_of({{kR, 0, 0.1807, 0, 1.570796327},
                 {kR, 0, 0, -0.6127, 0},
                 {kR, 0, 0, -0.57155, 0},
                 {kR, 0, 0.17415, 0, 1.570796327},
                 {kR, 0, 0.11985, 0, -1.570796327},
                 {kR, 0, 0.11655, 0, 0}});
}

// A real, factory-calibrated UR10e.
inline Arm ur10e_individual_a() {
  return arm_of(
      {{kR, 1.5961352531693174e-07, 0.18055510502488192, 0.00010865106862793039,
        1.5703515450471581},
       {kR, -0.9172096215288302, 303.4691356661582, -0.3723758247494677, -0.0016021511253121415},
       {kR, 7.129361313464995, -309.88394307789747, -0.5697437181978651, 0.006319177933310919},
       {kR, 0.07102990294243923, 6.58874904397395, 2.630761491656844e-05, 1.5691457745265918},
       {kR, -1.6425897652605492e-06, 0.11980517670998099, 3.966386325000127e-06,
        -1.570032644484455},
       {kR, 9.172861010348088e-08, 0.11567928597209635, 0.0, 0.0}});
}

// Another one.
inline Arm ur10e_individual_b() {
  return arm_of(
      {{kR, -2.4147806894359025e-07, 0.18053981171425867, 2.122348655712059e-05,
        1.5701460804424159},
       {kR, 1.6023395238669456, 439.14097407990096, 0.01931713262770063, 0.001394166668255904},
       {kR, -1.686071907521713, -446.02705980633215, -0.5692516636110877, 0.006938188803259951},
       {kR, 0.08373311477001187, 7.0603368964236015, -4.614090237209339e-05, 1.5699846854376098},
       {kR, -1.0126035587115778e-07, 0.11981134115031418, -6.392800534718015e-05,
        -1.5703852064954293},
       {kR, 3.919862091861237e-08, 0.11567091725742626, 0.0, 0.0}});
}

// Each arm with the drawing that it was built from.
struct KnownArm {
  std::string_view name;
  Arm arm;
  Arm nominal;
};

inline std::array<KnownArm, 10> known_arms() {
  return {{{"puma560", puma560(), puma560()},
           {"puma560-stone1986-robot1", puma560_robot1(), puma560()},
           {"puma560-stone1986-robot2", puma560_robot2(), puma560()},
           {"stanford", stanford(), stanford()},
           {"cobra600", cobra600(), cobra600()},
           {"iiwa7", iiwa7(), iiwa7()},
           {"ur5", ur5(), ur5()},
           {"ur10e", ur10e(), ur10e()},
           {"ur10e-individual-a", ur10e_individual_a(), ur10e()},
           {"ur10e-individual-b", ur10e_individual_b(), ur10e()}}};
}

}  // namespace armsig::testing
