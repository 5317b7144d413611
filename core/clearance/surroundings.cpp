// SPDX-License-Identifier: MIT
#include "core/clearance/surroundings.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::clearance {
namespace {

Vector3 off_mounting_plane(const Arm& arm) {
  const DhJoint& first = arm.joints[0];
  const bool below = first.type == JointType::kRevolute && first.d_m < 0;
  return {0, 0, below ? -1.0 : 1.0};
}

}  // namespace

Vector3 gravity_B(const Arm& arm, const Mounting& mounting) {
  switch (mounting.on) {
    case Mounting::On::kFloor:
      return -off_mounting_plane(arm);
    case Mounting::On::kCeiling:
      return off_mounting_plane(arm);
    case Mounting::On::kWall:
      return -Vector3::UnitX();
    case Mounting::On::kTilted:
      break;
  }
  return mounting.tilted_gravity_B;
}

double usual_link_radius_m(const Arm& arm) {
  constexpr double kShare = 0.05;
  double length_m = 0;
  for (std::size_t i = 1; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    double d_m = std::abs(row.d_m);
    if (row.type == JointType::kPrismatic) {
      d_m = std::max(std::abs(row.d_m + arm.limits[i].lower),
                     std::abs(row.d_m + arm.limits[i].upper));
    }
    length_m += std::hypot(row.a_m, d_m);
  }
  return kShare * length_m;
}

Surroundings surroundings_of(const Arm& arm, const Mounting& mounting) {
  Surroundings around;
  around.link_radius_m = mounting.link_radius_m.value_or(usual_link_radius_m(arm));
  const Vector3 normal_B = off_mounting_plane(arm);
  const Vector3 down_B = gravity_B(arm, mounting);
  constexpr double kStands = 1e-3;  // less of it is a wall
  const bool stands = -down_B.dot(normal_B) > kStands;
  if (!stands || !mounting.floor_m) around.planes.push_back({.normal_B = normal_B});
  if (mounting.floor_m) {
    around.planes.push_back(
        {.normal_B = -down_B, .offset_m = -*mounting.floor_m, .limit = Limit::kFloor});
    if (stands) around.foot_B = *mounting.floor_m * down_B;
  }
  return around;
}

}  // namespace armsig::clearance
