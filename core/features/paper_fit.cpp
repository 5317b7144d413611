// SPDX-License-Identifier: MIT
#include "core/features/motion_fits.hpp"
#include "core/features/regressions.hpp"

namespace armsig::features {
namespace {

// Sums over the points: weight * regressors * (p - centre)^T, with the regressors of the motion.
Matrix3 motion_moments(const SweepStatistics& statistics, const Vector3& centre) {
  const Matrix3 R = statistics.motion.factor();
  const Matrix3 Z = statistics.motion.rotated_right_hand_sides();
  // The first regressor is 1: subtracting the centre changes its column of the fit alone.
  return R.transpose() * (Z - R.col(0) * centre.transpose());
}

// Of the errors in height, radial distance and mean tangent on (centre, rotation vector, radius);
// `mean` of the points about the centre.
Eigen::Matrix<double, 7, 7> effect_of_errors(const JointFeature& circle, const Vector3& mean) {
  const Vector3& e = circle.radial_S;
  const Vector3& n = circle.axis_S;
  const Vector3 f = n.cross(e);
  const double r = circle.radius_m;
  // A tilt of height a1 x + a2 y turns the normal by -a1 e - a2 f. A radial distance b0 + b1 x +
  // b2 y moves the centre by r (b1 e + b2 f) and the radius by b0, because w changes by 2 r times
  // it; and the centre's motion turns the mean tangent.
  Eigen::Matrix<double, 7, 7> effect = Eigen::Matrix<double, 7, 7>::Zero();
  effect.block<3, 1>(0, 0) = n;
  effect.block<3, 1>(3, 1) = -f;
  effect.block<3, 1>(3, 2) = e;
  effect(6, 3) = 1;
  effect.block<3, 1>(0, 4) = r * e;
  effect.block<3, 1>(0, 5) = r * f;
  effect.block<3, 1>(3, 4) = n * (f.dot(mean) / r);
  effect.block<3, 1>(3, 5) = -n * (e.dot(mean) / r);
  effect.block<3, 1>(3, 6) = n;
  return effect;
}

// Covariance of (centre, rotation vector, radius).
Result<Eigen::Matrix<double, 7, 7>> circle_covariance(const SweepStatistics& statistics,
                                                      const JointFeature& circle) {
  const Vector3& e = circle.radial_S;
  const Vector3& n = circle.axis_S;
  const Vector3 f = n.cross(e);
  const double r = circle.radius_m;
  const Vector3 centre = circle.point_S - statistics.origin_S;

  // Regressors of (13) and (14): 1 and the coordinates in the plane about the centre.
  const Eigen::Matrix4d R = statistics.geometry().factor();
  SquareRootRls<3, 1> plane;
  for (int row = 0; row < 4; ++row) {
    const Vector3 p = R.block<1, 3>(row, 1).transpose() - R(row, 0) * centre;
    plane.update({R(row, 0), e.dot(p), f.dot(p)}, Eigen::Matrix<double, 1, 1>::Zero());
  }
  ARMSIG_TRY(root, plane.inverse_factor());
  const Matrix3 P = root * root.transpose();
  const double weights = R(0, 0) * R(0, 0);
  const Vector3 mean = R.block<1, 3>(0, 1).transpose() / R(0, 0) - centre;

  const Matrix3 shape = statistics.shape();
  const double along_normal = n.dot(shape * n);
  const double in_plane = (shape.trace() - along_normal) / 2;

  // Independent errors, to first order: height (1, x, y) of the plane; radial distance (1, x, y)
  // of the circle; the mean tangential error, as an angle.
  Eigen::Matrix<double, 7, 7> errors = Eigen::Matrix<double, 7, 7>::Zero();
  errors.block<3, 3>(0, 0) = along_normal * P;
  errors.block<3, 3>(3, 3) = in_plane * P;
  errors(6, 6) = in_plane / (weights * r * r);

  const Eigen::Matrix<double, 7, 7> effect = effect_of_errors(circle, mean);
  const Eigen::Matrix<double, 7, 7> carried = effect * errors;
  return carried * effect.transpose();
}

}  // namespace

Result<void> paper_circle(const SweepStatistics& statistics, JointFeature& feature) {
  if (statistics.motion.rank() < 3) return std::unexpected(Error::kSingular);
  const Geometry geometry = statistics.geometry();
  ARMSIG_TRY(plane, plane_of_rotation(geometry));
  ARMSIG_TRY(circle, centre_of_rotation(geometry, plane, squared_distance_in_plane(plane)));

  // Positive sense: the plane's normal along A x B of the readings' own circle.
  const MotionRls::Coefficients phi = statistics.motion.solve();
  const Vector3 sense = phi.row(1).cross(phi.row(2));
  const Vector3 n = sense.dot(plane.normal_S) < 0 ? Vector3(-plane.normal_S) : plane.normal_S;

  // The direction e of the target at the origin reading that brings e cos t + (n x e) sin t nearest
  // to all targets: along sum cos t (p - c) + sum sin t (p - c) x n, in the plane.
  const Matrix3 moments = motion_moments(statistics, circle.centre);
  const Vector3 cosines = (moments.row(0) - moments.row(2)).transpose();
  const Vector3 sines = moments.row(1).transpose();
  const Vector3 towards = cosines + sines.cross(n);

  feature.axis_S = n;
  feature.radial_S = (towards - n.dot(towards) * n).normalized();
  feature.point_S = statistics.origin_S + circle.centre;
  feature.radius_m = circle.radius_m;
  ARMSIG_TRY(covariance, circle_covariance(statistics, feature));
  feature.covariance = covariance;
  return {};
}

Result<void> paper_line(const SweepStatistics& statistics, JointFeature& feature) {
  if (statistics.motion.rank() < 2) return std::unexpected(Error::kSingular);
  ARMSIG_TRY(line, line_of_translation(statistics.geometry()));
  const MotionRls::Coefficients phi = statistics.motion.solve();
  const Vector3 u =
      phi.row(1).dot(line.direction_S) < 0 ? Vector3(-line.direction_S) : line.direction_S;
  // Along the line, the target at the origin reading is where the mean reading puts it.
  const Matrix3 R = statistics.motion.factor();
  const double mean_moved = R(0, 1) / R(0, 0);

  feature.axis_S = u;
  feature.radial_S = any_perpendicular(u);
  feature.point_S = statistics.origin_S + line.mean - mean_moved * u;
  feature.radius_m = 0;

  // The mean point and the slope are independent; the slope carries the point back to the origin.
  const Matrix3 shape = statistics.shape();
  const Matrix3 across = Matrix3::Identity() - u * u.transpose();
  const Matrix3 of_mean = shape / (R(0, 0) * R(0, 0));
  const Matrix3 of_slope = across * shape * across / (R(1, 1) * R(1, 1));
  Eigen::Matrix<double, 6, 3> effect;  // of a change of direction: on the point, as a rotation
  effect << -mean_moved * Matrix3::Identity(), cross_matrix(u);
  feature.covariance.setZero();
  feature.covariance.topLeftCorner<6, 6>() = effect * of_slope * effect.transpose();
  feature.covariance.topLeftCorner<3, 3>() += of_mean;
  return {};
}

}  // namespace armsig::features
