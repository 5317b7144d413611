// SPDX-License-Identifier: MIT
// All postures in which six revolute joints bring frame n to a pose, by a search in one reading.
//
// Given the reading of joint 6, axis 5 is known in frame 0. Joints 1 to 3 bring the point of axis 5
// that is nearest to axis 4 to its place, in four ways at most, and what is left is one number,
//   f(q_6) = z_3 . z_4 - cos(alpha_4):
// whether axis 5 lies where joint 4 can turn it. The zeros of f over one turn, on all four ways,
// are the postures (Pieper, The kinematics of manipulators under computer control, 1968, for the
// point; Manocha and Canny, IEEE Trans. Robotics and Automation 10, 1994: 16 at most).
//
// The ways are continuous in q_6 and meet where the arm is stretched or the point passes beside
// axis 1, so that f is followed along them and across: its changes of sign, and its approaches to
// zero, are bracketed. Where axes 2 and 3 are taken for parallel or axes 4 and 5 for meeting, f is
// off by little; next to zero it is evaluated on the chain as it is.
#pragma once

#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics {

// Six revolute joints, axes 1 and 2 at right angles, axes 2 and 3 parallel, axes 4 and 5 meeting,
// all within what individual arms differ by: wrists whose axes meet, three parallel axes, and
// wrists with an offset.
[[nodiscard]] bool can_search_postures(const Chain& chain);

inline constexpr std::size_t kMaxStarts = 96;
using PostureStarts = FixedVector<JointVector, kMaxStarts>;

// Readings in (-pi, pi] from which Newton's method reaches the postures; several may lead to one.
// Preconditions: can_search_postures(); X_0n finite.
[[nodiscard]] PostureStarts search_postures(const Chain& chain, const Pose& X_0n);

}  // namespace armsig::kinematics
