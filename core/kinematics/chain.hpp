// SPDX-License-Identifier: MIT
// The constants of a pseudo Denavit-Hartenberg chain (21), prepared for the servo loop.
//
// Near-parallel axes give rows whose d is hundreds of metres and cancels in the product. A frame
// may slide along its own z axis without changing the product, so make_chain moves every frame back
// to where the arm is: afterwards no constant is longer than the arm, and neither double nor single
// precision loses a digit to the cancellation. A link is then
//   Rot(z, theta) Trans(x, y, z) Rot(x, alpha).
#pragma once

#include <array>
#include <cstddef>

#include "core/base/arm.hpp"

namespace armsig::kinematics {

// Constants per joint, base to tip; lengths in metres, angles in radians. Entries beyond
// joint_count are zero.
template <typename Scalar>
struct ChainT {
  using Lanes = std::array<Scalar, kMaxJoints>;

  alignas(32) Lanes theta{};  // added to the reading of a revolute joint
  alignas(32) Lanes x{};      // translation of the link after Rot(z, theta)
  Lanes y{};
  alignas(32) Lanes z{};  // the reading of a prismatic joint is added to it
  Lanes cos_alpha{};
  Lanes sin_alpha{};
  std::array<bool, kMaxJoints> revolute{};
  std::size_t joint_count = 0;
  bool has_prismatic = false;
  FixedVector<JointLimits, kMaxJoints> limits;  // of the readings; empty: none
};
using Chain = ChainT<double>;

// The chain of 1 to kMaxJoints `rows`; `limits` is empty or has one entry per row with
// lower <= upper (else a mistake of the caller). Finite rows are the caller's duty.
[[nodiscard]] Chain make_chain(const FixedVector<DhJoint, kMaxJoints>& rows,
                               const FixedVector<JointLimits, kMaxJoints>& limits = {});

// The same chain in single precision. The constants are rounded after the frames were moved, so the
// result is good to a few 1e-7 of the arm's length.
[[nodiscard]] ChainT<float> to_single(const Chain& chain);

}  // namespace armsig::kinematics
