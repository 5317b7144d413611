// SPDX-License-Identifier: MIT
#include "core/features/feature.hpp"

namespace armsig::features {

Vector3 JointFeature::target_at(double reading) const {
  const double moved = reading - reference_reading;
  if (type == JointType::kPrismatic) return point_S + moved * axis_S;
  return point_S +
         radius_m * (std::cos(moved) * radial_S + std::sin(moved) * axis_S.cross(radial_S));
}

Matrix3 JointFeature::target_covariance_at(double reading) const {
  const Vector3 from_point = target_at(reading) - point_S;
  Eigen::Matrix<double, 3, 7> by_parameters = Eigen::Matrix<double, 3, 7>::Zero();
  by_parameters.leftCols<3>().setIdentity();
  by_parameters.middleCols<3>(3) = -cross_matrix(from_point);
  if (radius_m > 0) by_parameters.col(6) = from_point / radius_m;
  return by_parameters * covariance * by_parameters.transpose();
}

}  // namespace armsig::features
