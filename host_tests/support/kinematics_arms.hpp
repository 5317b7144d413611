// SPDX-License-Identifier: MIT
// The paper's and the shared data's arms as the kinematics tests use them: exact chains, with their
// limits.
#pragma once

#include <array>
#include <string>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "firmware/host_tool/paper_arms.hpp"
#include "host_tests/support/shared_arms.hpp"

namespace armsig::test {

struct KnownArm {
  std::string name;
  FixedVector<DhJoint, kMaxJoints> rows;
  FixedVector<JointLimits, kMaxJoints> limits;
};

inline KnownArm known(const std::string& name, const Arm& arm) {
  return {name, arm.joints, arm.limits};
}
inline KnownArm shared(const std::string& name) { return known(name, shared_arm(name)); }

inline KnownArm puma560() { return known("puma560", tool::puma560()); }
inline KnownArm puma560_stone1986_robot1() { return known("robot 1", tool::table2_robot(1)); }
inline KnownArm puma560_stone1986_robot2() { return known("robot 2", tool::table2_robot(2)); }
inline KnownArm stanford() { return shared("stanford"); }
inline KnownArm ur5() { return shared("ur5"); }
inline KnownArm ur10e() { return shared("ur10e"); }
inline KnownArm ur10e_individual_a() { return shared("ur10e-individual-a"); }
inline KnownArm ur10e_individual_b() { return shared("ur10e-individual-b"); }
inline KnownArm cobra600() { return shared("cobra600"); }
inline KnownArm iiwa7() { return shared("iiwa7"); }

inline std::array<KnownArm, 8> six_joint_arms() {
  return {puma560(), puma560_stone1986_robot1(), puma560_stone1986_robot2(), stanford(), ur5(),
          ur10e(),   ur10e_individual_a(),       ur10e_individual_b()};
}

inline std::array<KnownArm, 10> known_arms() {
  return {puma560(), puma560_stone1986_robot1(), puma560_stone1986_robot2(), stanford(), ur5(),
          ur10e(),   ur10e_individual_a(),       ur10e_individual_b(),       cobra600(), iiwa7()};
}

}  // namespace armsig::test
