// SPDX-License-Identifier: MIT
// The tables' plain arrays as the types of the core.
#pragma once

#include <array>
#include <cstddef>
#include <new>
#include <span>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/identification.hpp"
#include "firmware/selftest/known_answers.hpp"

namespace armsig::selftest {

[[nodiscard]] inline JointVector readings(std::span<const double> q, std::size_t count) {
  JointVector result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(q[i]);
  return result;
}

[[nodiscard]] inline Vector3 vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

[[nodiscard]] inline Matrix3 matrix(const std::array<double, 9>& m) {
  return Matrix3{{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
}

[[nodiscard]] inline DhRows rows(std::span<const DhJoint> from, std::size_t count) {
  DhRows result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(from[i]);
  return result;
}

// The signature of an exact arm, as it would be stored, at its first known pose. Made in its own
// place, as it is too large for a stack; the next one takes that place.
[[nodiscard]] inline const Signature& signature_of_known(const KnownArm& known) {
  alignas(Signature) static std::array<std::byte, sizeof(Signature)> place;
  Arm arm;
  arm.joints = rows(known.rows, known.joint_count);
  const JointVector q_s = readings(known.poses[0].q, known.joint_count);
  return *new (place.data()) Signature(signature_of(arm, q_s, Pose{}, {}));
}

}  // namespace armsig::selftest
