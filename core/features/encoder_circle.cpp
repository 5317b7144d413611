// SPDX-License-Identifier: MIT
#include "core/features/encoder_circle.hpp"

#include <cmath>

#include "core/features/constrained_fit.hpp"

namespace armsig::features {
namespace {

// The seven free parameters, as steps: target at the origin reading, rotation vector, radius. The
// target, not the centre, because a short arc ties the centre to the other four.
struct Circle {
  static constexpr int kParameters = 7;
  using Step = Eigen::Matrix<double, kParameters, 1>;

  Vector3 target;  // about the origin of the statistics
  Matrix3 R_SC;
  double radius;

  // p = target + f r sin t - e r (1 - cos t)
  [[nodiscard]] MotionRls::Coefficients coefficients() const {
    MotionRls::Coefficients phi;
    phi.row(0) = target;
    phi.row(1) = radius * R_SC.col(1);
    phi.row(2) = -radius * R_SC.col(0);
    return phi;
  }

  [[nodiscard]] MotionJacobian<kParameters> jacobian() const {
    MotionJacobian<kParameters> D = MotionJacobian<kParameters>::Zero();
    D.block<3, 3>(0, 0).setIdentity();
    D.block<3, 3>(3, 3) = -radius * cross_matrix(R_SC.col(1));
    D.block<3, 3>(6, 3) = radius * cross_matrix(R_SC.col(0));
    D.block<3, 1>(3, 6) = R_SC.col(1);
    D.block<3, 1>(6, 6) = -R_SC.col(0);
    return D;
  }

  [[nodiscard]] Circle moved(const Step& step) const {
    const Vector3 turn = step.segment<3>(3);
    const double angle = turn.norm();
    const Matrix3 turned = angle > 0 ? Matrix3(rotation_about(turn / angle, angle) * R_SC) : R_SC;
    return {target + step.head<3>(), turned, radius + step[6]};
  }

  [[nodiscard]] bool is_small(const Step& step) const {
    constexpr double kRounding = 1e-15;
    return step.segment<3>(3).norm() < kRounding && step.head<3>().norm() < kRounding * radius &&
           std::abs(step[6]) < kRounding * radius;
  }
};

// The circle nearest to A and B in the sense of least squares on the two vectors themselves:
// orthogonal Procrustes, [A B] = Q S with S = ([A B]^T [A B])^(1/2) in closed form.
Result<Circle> nearest_circle(const MotionRls::Coefficients& phi) {
  Eigen::Matrix<double, 3, 2> AB;
  AB.col(0) = -phi.row(2).transpose();
  AB.col(1) = phi.row(1).transpose();
  const Eigen::Matrix2d square = AB.transpose() * AB;
  const double root_of_determinant = AB.col(0).cross(AB.col(1)).norm();
  const double trace = std::sqrt(square.trace() + 2 * root_of_determinant);
  if (!(root_of_determinant > 0)) return std::unexpected(Error::kSingular);
  const Eigen::Matrix2d S = (square + root_of_determinant * Eigen::Matrix2d::Identity()) / trace;
  const Eigen::Matrix<double, 3, 2> Q = AB * S.inverse();
  Circle circle;
  circle.target = phi.row(0);
  circle.radius = trace / 2;
  circle.R_SC.col(0) = Q.col(0).normalized();
  circle.R_SC.col(2) = Q.col(0).cross(Q.col(1)).normalized();
  circle.R_SC.col(1) = circle.R_SC.col(2).cross(circle.R_SC.col(0));
  return circle;
}

}  // namespace

MotionRls::Coefficients CircleFit::motion(const Vector3& origin_S) const {
  return Circle{centre_S + radius_m * R_SC.col(0) - origin_S, R_SC, radius_m}.coefficients();
}

Result<CircleFit> encoder_circle(const SweepStatistics& statistics) {
  if (statistics.motion.rank() < 3) return std::unexpected(Error::kSingular);
  ARMSIG_TRY(start, nearest_circle(statistics.motion.solve()));
  const ConstrainedFit<Circle> fit(statistics);
  ARMSIG_TRY(circle, fit.maximise_likelihood(start));
  ARMSIG_TRY(covariance, fit.covariance(circle));

  CircleFit result;
  result.R_SC = circle.R_SC;
  result.radius_m = circle.radius;
  result.centre_S = statistics.origin_S + circle.target - circle.radius * circle.R_SC.col(0);
  // From the target to the centre = target - r e.
  Eigen::Matrix<double, 7, 7> to_centre = Eigen::Matrix<double, 7, 7>::Identity();
  to_centre.block<3, 3>(0, 3) = circle.radius * cross_matrix(circle.R_SC.col(0));
  to_centre.block<3, 1>(0, 6) = -circle.R_SC.col(0);
  const Eigen::Matrix<double, 7, 7> carried = to_centre * covariance;
  result.covariance = carried * to_centre.transpose();
  return result;
}

}  // namespace armsig::features
