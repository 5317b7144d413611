// SPDX-License-Identifier: MIT
#include "core/features/feature.hpp"

namespace armsig::features {

Vector3 JointFeature::target_at(double reading) const {
  const double moved = reading - reference_reading;
  if (type == JointType::kPrismatic) return point_S + moved * axis_S;
  return point_S +
         radius_m * (std::cos(moved) * radial_S + std::sin(moved) * axis_S.cross(radial_S));
}

}  // namespace armsig::features
