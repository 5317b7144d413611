// SPDX-License-Identifier: MIT
// What the readings of a solution are confined to: the limits of the joints, and the largest change
// from the seed that one tick allows.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "core/kinematics/inverse.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::kinematics {

using Joints = numerics::Column;  // zero beyond the joint count
using numerics::Square;

struct JointBox {
  Joints lower = Joints::Constant(-std::numeric_limits<double>::infinity());
  Joints upper = Joints::Constant(std::numeric_limits<double>::infinity());
  // Whether a bound is the largest step; else it is a limit of the joint.
  std::array<bool, kMaxJoints> lower_is_step{};
  std::array<bool, kMaxJoints> upper_is_step{};

  [[nodiscard]] Joints clamped(const Joints& q) const { return q.cwiseMax(lower).cwiseMin(upper); }
  // Whether reading i stands at the bound against which `push` would move it.
  [[nodiscard]] bool stops(Eigen::Index i, double reading, double push) const {
    return (push > 0 && reading >= upper[i]) || (push < 0 && reading <= lower[i]);
  }
  [[nodiscard]] bool stops_by_step(Eigen::Index i, double push) const {
    const auto k = static_cast<std::size_t>(i);
    return push > 0 ? upper_is_step[k] : lower_is_step[k];
  }
};

// The seed may stand outside the limits: by more than a step, it can only move towards them.
[[nodiscard]] JointBox joint_box(const Chain& chain, const JointVector& seed,
                                 const InverseOptions& options);

}  // namespace armsig::kinematics
