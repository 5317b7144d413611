// SPDX-License-Identifier: MIT
// A nominal arm: standard (distal) Denavit-Hartenberg rows, limits, couplings, and how it stands.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"

namespace armsig {

inline constexpr std::size_t kMaxJoints = 8;
inline constexpr std::size_t kMaxFrames = kMaxJoints + 1;

enum class JointType : std::uint8_t { kRevolute, kPrismatic };
using JointTypes = FixedVector<JointType, kMaxJoints>;

// One value per joint, base to tip: radians for a revolute joint, metres for a prismatic one.
using JointVector = FixedVector<double, kMaxJoints>;

// One row of the standard Denavit-Hartenberg model, (2) of the paper:
//   A = Rot(z, theta) Trans(0, 0, d) Trans(a, 0, 0) Rot(x, alpha).
// The joint reading is added to theta of a revolute joint, to d of a prismatic one, as in (20).
struct DhJoint {
  JointType type = JointType::kRevolute;
  double theta_rad = 0;
  double d_m = 0;
  double a_m = 0;
  double alpha_rad = 0;
};

using DhRows = FixedVector<DhJoint, kMaxJoints>;

// Limits of the joint reading, radians or metres.
struct JointLimits {
  double lower = 0;
  double upper = 0;
};

// The effective reading of `joint` is its reading plus ratio times the reading of `from` (indices
// from 0).
struct JointCoupling {
  std::size_t joint = 0;
  std::size_t from = 0;
  double ratio = 0;
};

using JointCouplings = FixedVector<JointCoupling, kMaxJoints>;

struct Arm {
  DhRows joints;
  FixedVector<JointLimits, kMaxJoints> limits;  // as many as joints
  JointCouplings couplings;
  // Against gravity, in frame 0; of length 1. Frame 0 has its z axis along joint 1, so that an arm
  // on a wall, or one whose first joint is a rail, has another direction than z.
  Vector3 up_0 = Vector3::UnitZ();
};

// The types of `joints`, of whatever has one: rows of a drawing, axes, models of joints.
template <typename Joints>
[[nodiscard]] JointTypes types_of(const Joints& joints) {
  JointTypes types;
  for (const auto& joint : joints) types.push_back(joint.type);
  return types;
}

// The largest difference of a reading. Precondition: as many in both.
[[nodiscard]] inline double largest_change(const JointVector& from, const JointVector& to) {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    largest = std::max(largest, std::abs(to[i] - from[i]));
  }
  return largest;
}

// The readings that move the joints: each coupled one with its share of the other's reading added.
// Precondition: one reading a joint.
[[nodiscard]] inline JointVector effective_readings(const JointCouplings& couplings,
                                                    const JointVector& readings) {
  JointVector effective = readings;
  for (const JointCoupling& coupling : couplings) {
    effective[coupling.joint] += coupling.ratio * readings[coupling.from];
  }
  return effective;
}
[[nodiscard]] inline JointVector effective_readings(const Arm& arm, const JointVector& readings) {
  return effective_readings(arm.couplings, readings);
}

// The readings whose effective_readings() are `effective`. Preconditions: one value a joint; no
// coupling leads back, through others, to the joint that it moves.
[[nodiscard]] inline JointVector readings_for(const JointCouplings& couplings,
                                              const JointVector& effective) {
  JointVector readings = effective;
  // Every pass settles the joints that hang on settled ones.
  for (std::size_t pass = 0; pass < effective.size(); ++pass) {
    JointVector next = effective;
    for (const JointCoupling& coupling : couplings) {
      next[coupling.joint] -= coupling.ratio * readings[coupling.from];
    }
    readings = next;
  }
  return readings;
}

}  // namespace armsig
