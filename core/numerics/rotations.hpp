// SPDX-License-Identifier: MIT
// The exponential of rotations, whose logarithm is rotation_vector() of core/base/pose.hpp, and the
// angle between vectors.
#pragma once

#include <cmath>

#include "core/base/pose.hpp"

namespace armsig::numerics {

// The rotation about `turn` by its length [rad] (Rodrigues); exactly the identity where that is 0.
[[nodiscard]] inline Matrix3 rotation_by(const Vector3& turn) {
  const double angle = turn.norm();
  return angle > 0 ? rotation_about(turn / angle, angle) : Matrix3::Identity();
}

// In [0, pi], of vectors of any length; accurate to rounding near 0 and pi, where an arc cosine is
// not (Kahan, "How futile are mindless assessments of roundoff", 2006, section 12). 0 where one of
// them is zero.
[[nodiscard]] inline double angle_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace armsig::numerics
