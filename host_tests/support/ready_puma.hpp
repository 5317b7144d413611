// SPDX-License-Identifier: MIT
// The Puma as a chain, and readings far from every fold of it.
#pragma once

#include "core/kinematics/chain.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::test {

inline kinematics::Chain puma_chain() {
  return kinematics::make_chain(puma560().joints, puma560().limits);
}
// Its first rows, an arm of fewer joints.
inline DhRows puma_rows(std::size_t count) {
  DhRows rows = puma560().joints;
  rows.resize(count);
  return rows;
}
inline const JointVector kReady{0.2, -0.8, 0.9, 0.3, 0.7, -0.4};

}  // namespace armsig::test
