// SPDX-License-Identifier: MIT
// The paper's and the shared data's arms as the tests of the identification use them: at readings
// of half a turn either way, or of half a metre.
#pragma once

#include <array>
#include <initializer_list>
#include <string>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "firmware/host_tool/paper_arms.hpp"
#include "host_tests/support/shared_arms.hpp"

namespace armsig::testing {

inline constexpr JointType kR = JointType::kRevolute;
inline constexpr JointType kP = JointType::kPrismatic;

inline DhJoint row_mm_deg(JointType type, double theta_deg, double d_mm, double a_mm,
                          double alpha_deg) {
  return {type, radians(theta_deg), d_mm * 1e-3, a_mm * 1e-3, radians(alpha_deg)};
}

inline Arm arm_of(const FixedVector<DhJoint, kMaxJoints>& rows) {
  Arm arm;
  for (const DhJoint& row : rows) {
    arm.joints.push_back(row);
    arm.limits.push_back(row.type == kR ? JointLimits{-kPi, kPi} : JointLimits{0.0, 0.5});
  }
  return arm;
}
inline Arm arm_of(std::initializer_list<DhJoint> rows) {
  return arm_of(FixedVector<DhJoint, kMaxJoints>(rows));
}

inline Arm puma560() { return arm_of(tool::puma560().joints); }
inline Arm puma560_robot1() { return arm_of(tool::table2_robot(1).joints); }
inline Arm puma560_robot2() { return arm_of(tool::table2_robot(2).joints); }
inline Arm shared(const std::string& name) { return arm_of(test::shared_arm(name).joints); }
inline Arm stanford() { return shared("stanford"); }
inline Arm cobra600() { return shared("cobra600"); }
inline Arm iiwa7() { return shared("iiwa7"); }
inline Arm ur5() { return shared("ur5"); }
inline Arm ur10e() { return shared("ur10e"); }
inline Arm ur10e_individual_a() { return shared("ur10e-individual-a"); }
inline Arm ur10e_individual_b() { return shared("ur10e-individual-b"); }

// Each arm with the drawing that it was built from.
struct KnownArm {
  std::string name;
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
