// SPDX-License-Identifier: MIT
// The arms that many tests use: the paper's, and those of the shared data.
#pragma once

#include <array>
#include <string>

#include "core/base/arm.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/shared_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::test {

// An arm as it is, and the drawing that it was built from.
struct KnownArm : Arm {
  std::string name;
  Arm drawing;
};

inline KnownArm drawn(const std::string& name, const Arm& arm) { return {arm, name, arm}; }
inline KnownArm shared(const std::string& name) { return drawn(name, shared_arm(name)); }

inline KnownArm puma560() { return drawn("puma560", tool::puma560()); }
inline KnownArm puma560_robot1() { return {tool::table2_robot(1), "robot 1", tool::puma560()}; }
inline KnownArm puma560_robot2() { return {tool::table2_robot(2), "robot 2", tool::puma560()}; }
inline KnownArm stanford() { return shared("stanford"); }
inline KnownArm cobra600() { return shared("cobra600"); }
inline KnownArm iiwa7() { return shared("iiwa7"); }
inline KnownArm ur5() { return shared("ur5"); }
inline KnownArm ur10e() { return shared("ur10e"); }
inline KnownArm ur10e_individual_a() {
  return {shared_arm("ur10e-individual-a"), "ur10e-individual-a", shared_arm("ur10e")};
}
inline KnownArm ur10e_individual_b() {
  return {shared_arm("ur10e-individual-b"), "ur10e-individual-b", shared_arm("ur10e")};
}

inline std::array<KnownArm, 8> six_joint_arms() {
  return {puma560(), puma560_robot1(), puma560_robot2(),     stanford(),
          ur5(),     ur10e(),          ur10e_individual_a(), ur10e_individual_b()};
}

inline std::array<KnownArm, 10> known_arms() {
  return {puma560(), puma560_robot1(),     puma560_robot2(),     stanford(), ur5(),
          ur10e(),   ur10e_individual_a(), ur10e_individual_b(), cobra600(), iiwa7()};
}

}  // namespace armsig::test
