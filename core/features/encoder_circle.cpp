// SPDX-License-Identifier: MIT
#include "core/features/encoder_circle.hpp"

#include <cmath>

#include "core/features/constrained_fit.hpp"

namespace armsig::features {
namespace {

// The four parameters about the target, as steps: rotation vector, radius.
struct Circle {
  static constexpr int kParameters = 4;
  using Step = Eigen::Matrix<double, kParameters, 1>;

  Matrix3 R_SC;
  double radius;

  // p = target + f r sin t - e r (1 - cos t)
  [[nodiscard]] MotionRows rows() const {
    MotionRows rows;
    rows.row(0) = radius * R_SC.col(1);
    rows.row(1) = -radius * R_SC.col(0);
    return rows;
  }

  [[nodiscard]] MotionJacobian<kParameters> jacobian() const {
    MotionJacobian<kParameters> D;
    D.block<3, 3>(0, 0) = -radius * cross_matrix(R_SC.col(1));
    D.block<3, 3>(3, 0) = radius * cross_matrix(R_SC.col(0));
    D.block<3, 1>(0, 3) = R_SC.col(1);
    D.block<3, 1>(3, 3) = -R_SC.col(0);
    return D;
  }

  [[nodiscard]] Circle moved(const Step& step) const {
    const Vector3 turn = step.head<3>();
    const double angle = turn.norm();
    const Matrix3 turned = angle > 0 ? Matrix3(rotation_about(turn / angle, angle) * R_SC) : R_SC;
    return {turned, radius + step[3]};
  }

  [[nodiscard]] bool is_small(const Step& step) const {
    constexpr double kSmall = 1e-12;
    return step.head<3>().norm() < kSmall && std::abs(step[3]) < kSmall * radius;
  }
};

// The circle of greatest likelihood for points measured equally well in all directions, and a start
// for all others. With s_ij and z_i the lower rows of R and Z,
//   |s11 r f - s12 r e - z1|^2 + |s22 r e + z2|^2
//     = r^2 (s11^2 + s12^2 + s22^2) - 2 r (e.a + f.b) + const,   a = -s12 z1 - s22 z2,  b = s11 z1,
// because e and f are unit vectors at right angles: orthogonal Procrustes, whose solution is the
// polar factor of [a b] = [e f] S with S = ([a b]^T [a b])^(1/2) in closed form, r = trace S / sum.
Result<Circle> nearest_circle(const Matrix3& R, const MotionRls::Coefficients& Z) {
  Eigen::Matrix<double, 3, 2> ab;
  ab.col(0) = -(R(1, 2) * Z.row(1) + R(2, 2) * Z.row(2)).transpose();
  ab.col(1) = R(1, 1) * Z.row(1).transpose();
  const Eigen::Matrix2d square = ab.transpose().lazyProduct(ab);
  const double root_of_determinant = ab.col(0).cross(ab.col(1)).norm();
  if (!(root_of_determinant > 0)) return std::unexpected(Error::kSingular);
  const double trace = std::sqrt(square.trace() + 2 * root_of_determinant);
  const Eigen::Matrix2d S = (square + root_of_determinant * Eigen::Matrix2d::Identity()) / trace;
  const Eigen::Matrix<double, 3, 2> ef = ab.lazyProduct(S.inverse());
  Circle circle;
  circle.radius = trace / (R(1, 1) * R(1, 1) + R(1, 2) * R(1, 2) + R(2, 2) * R(2, 2));
  circle.R_SC.col(0) = ef.col(0).normalized();
  circle.R_SC.col(2) = ef.col(0).cross(ef.col(1)).normalized();
  circle.R_SC.col(1) = circle.R_SC.col(2).cross(circle.R_SC.col(0));
  return circle;
}

bool is_isotropic(const Matrix3& covariance) {
  return covariance == covariance(0, 0) * Matrix3::Identity();
}

// The nearest circle with its covariance, for points measured equally well in all directions. About
// the axes e, f, n of the circle, with w its turn, the rows of the factor see
//   d(r f) = r (w_e n - w_n e) + dr f,   d(r e) = r (w_n f - w_f n) + dr e,
// so the information about psi falls into w_n, dr (both alone, in-plane) and the pair w_e, w_f. The
// target takes up the first row, hence for the centre = target - r e
//   d centre = -alpha d(r f) + beta d(r e),   alpha = s01 / s00,  beta = s02 / s00 - 1,
// and the noise of the target itself, 1 / s00 in every direction.
CircleFit isotropic_fit(const Circle& circle, const Matrix3& R, const MotionRls::Coefficients& Z,
                        const Vector3& origin_S) {
  const double r = circle.radius;
  const Vector3 e = circle.R_SC.col(0);
  const Vector3 f = circle.R_SC.col(1);
  const Vector3 n = circle.R_SC.col(2);
  const double of_target = 1 / R(0, 0);
  const double alpha = R(0, 1) * of_target;
  const double beta = R(0, 2) * of_target - 1;

  CircleFit result;
  result.R_SC = circle.R_SC;
  result.radius_m = r;
  result.centre_S = origin_S + of_target * Z.row(0).transpose() + r * (beta * e - alpha * f);

  const double in_plane = 1 / (R(1, 1) * R(1, 1) + R(1, 2) * R(1, 2) + R(2, 2) * R(2, 2));
  const double root = 1 / (r * R(1, 1) * R(2, 2));
  const double s_ee = root * root * (R(1, 2) * R(1, 2) + R(2, 2) * R(2, 2));
  const double s_ef = -root * root * R(1, 1) * R(1, 2);
  const double s_ff = root * root * R(1, 1) * R(1, 1);
  // Of the centre along n with w_e and w_f.
  const double s_ne = -r * (alpha * s_ee + beta * s_ef);
  const double s_nf = -r * (alpha * s_ef + beta * s_ff);
  const double of_centre = (alpha * alpha + beta * beta) * in_plane;
  const double s_nn = -r * (alpha * s_ne + beta * s_nf);

  auto& covariance = result.covariance;
  const Vector3 turn_e = s_ee * e + s_ef * f;
  const Vector3 turn_f = s_ef * e + s_ff * f;
  const Vector3 turn_n = in_plane / (r * r) * n;
  const Vector3 of_turn = s_ne * e + s_nf * f;
  const Vector3 of_n = in_plane / r * (alpha * e + beta * f);
  const Vector3 of_radius = in_plane * (beta * e - alpha * f);
  for (int j = 0; j < 3; ++j) {
    covariance.col(j).head<3>() = (s_nn - of_centre) * n[j] * n;
    covariance(j, j) += of_centre + of_target * of_target;
    covariance.col(3 + j).head<3>() = n[j] * of_n + of_turn[j] * n;
    covariance.col(3 + j).segment<3>(3) = e[j] * turn_e + f[j] * turn_f + n[j] * turn_n;
    covariance.row(3 + j).head<3>() = covariance.col(3 + j).head<3>();
  }
  covariance.col(6).head<3>() = of_radius;
  covariance.row(6).head<3>() = of_radius;
  covariance(6, 6) = in_plane;
  return result;
}

}  // namespace

MotionRls::Coefficients CircleFit::motion(const Vector3& origin_S) const {
  MotionRls::Coefficients phi;
  phi.row(0) = centre_S + radius_m * R_SC.col(0) - origin_S;
  phi.bottomRows<2>() = Circle{R_SC, radius_m}.rows();
  return phi;
}

Result<CircleFit> encoder_circle(const MotionStatistics& statistics) {
  if (statistics.motion.rank() < 3) return std::unexpected(Error::kSingular);
  const Matrix3 R = statistics.motion.factor();
  const MotionRls::Coefficients Z = statistics.motion.rotated_right_hand_sides();
  ARMSIG_TRY(start, nearest_circle(R, Z));
  if (statistics.has_one_covariance() && is_isotropic(statistics.first_covariance_m2))
    return isotropic_fit(start, R, Z, statistics.origin_S);
  const ConstrainedFit<Circle> fit(statistics);
  ARMSIG_TRY(fitted, fit.maximise_likelihood(start));
  const Circle& circle = fitted.motion;
  auto covariance = fit.covariance(fitted);

  CircleFit result;
  result.R_SC = circle.R_SC;
  result.radius_m = circle.radius;
  const Vector3 e = circle.R_SC.col(0);
  result.centre_S = statistics.origin_S + fit.target(circle) - circle.radius * e;
  // From the target to the centre = target - r e.
  Eigen::Matrix<double, 3, 4> moves_centre;
  moves_centre << circle.radius * cross_matrix(e), -e;
  covariance.topRows<3>() += moves_centre.lazyProduct(covariance.bottomRows<4>());
  covariance.leftCols<3>() += covariance.rightCols<4>().lazyProduct(moves_centre.transpose());
  result.covariance = covariance;
  return result;
}

}  // namespace armsig::features
