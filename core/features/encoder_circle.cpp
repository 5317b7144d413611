// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/features/constrained_fit.hpp"
#include "core/features/motion_fits.hpp"
#include "core/numerics/rotations.hpp"

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
    return {numerics::rotation_by(step.head<3>()) * R_SC, radius + step[3]};
  }

  [[nodiscard]] bool is_small(const Step& step) const {
    constexpr double kSmall = 1e-12;
    return step.head<3>().norm() < kSmall && std::abs(step[3]) < kSmall * radius;
  }
};

// The triangular factor as it is kept, R = D^1/2 U and Z = D^1/2 zeta: no root has to be taken to
// fit a circle to it.
struct KeptFactor {
  explicit KeptFactor(const MotionRls& motion)
      : d0(motion.rows()[0][0]),
        d1(motion.rows()[1][1]),
        d2(motion.rows()[2][2]),
        u01(motion.rows()[0][1]),
        u02(motion.rows()[0][2]),
        u12(motion.rows()[1][2]),
        zeta0(motion.rows()[0].data() + 3),
        zeta1(motion.rows()[1].data() + 3),
        zeta2(motion.rows()[2].data() + 3) {}

  // Of the lower rows of U D U^T: what the readings say about the radius.
  [[nodiscard]] double in_plane() const { return d1 + d1 * u12 * u12 + d2; }

  double d0, d1, d2, u01, u02, u12;
  Eigen::Map<const Vector3> zeta0, zeta1, zeta2;
};

// The circle of greatest likelihood for points measured equally well in all directions, and a start
// for all others. The part of the misfit that psi changes is
//   d1 |r f - u12 r e - zeta1|^2 + d2 |r e + zeta2|^2
//     = r^2 (d1 + d1 u12^2 + d2) - 2 r (e.a + f.b) + const,   a = -d1 u12 zeta1 - d2 zeta2,
//                                                             b = d1 zeta1,
// because e and f are unit vectors at right angles: orthogonal Procrustes, whose solution is the
// polar factor of [a b] = [e f] S with S = ([a b]^T [a b])^(1/2) in closed form, r = trace S / sum.
// By Cayley and Hamilton S^-1 = (trace S - S) / det S, so that e is along (b.b + det) a - (a.b) b.
Result<Circle> nearest_circle(const KeptFactor& kept) {
  const Vector3 b = kept.d1 * kept.zeta1;
  const Vector3 a = -kept.u12 * b - kept.d2 * kept.zeta2;
  const double aa = a.squaredNorm();
  const double ab = a.dot(b);
  const double bb = b.squaredNorm();
  const Vector3 normal = a.cross(b);
  const double determinant = normal.norm();
  if (!(determinant > 0)) return std::unexpected(Error::kSingular);
  const Vector3 n = normal / determinant;
  const Vector3 f = n.cross((bb + determinant) * a - ab * b).normalized();
  Circle circle;
  circle.R_SC.col(0) = f.cross(n);
  circle.R_SC.col(1) = f;
  circle.R_SC.col(2) = n;
  circle.radius = std::sqrt(aa + bb + 2 * determinant) / kept.in_plane();
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
//   d centre = -alpha d(r f) + beta d(r e),   alpha = u01,  beta = u02 - 1,
// and the noise of the target itself, of variance 1 / d0 in every direction.
void take_isotropic(const Circle& circle, const KeptFactor& kept, const Vector3& origin_S,
                    JointFeature& feature) {
  const double r = circle.radius;
  const Vector3 e = circle.R_SC.col(0);
  const Vector3 f = circle.R_SC.col(1);
  const Vector3 n = circle.R_SC.col(2);
  const double of_target = 1 / kept.d0;
  const double alpha = kept.u01;
  const double beta = kept.u02 - 1;

  feature.point_S = origin_S + kept.zeta0 + r * (beta * e - alpha * f);

  const double in_plane = 1 / kept.in_plane();
  const double curvature = 1 / r;
  const double s_ff = curvature * curvature / kept.d2;
  const double s_ef = -kept.u12 * s_ff;
  const double s_ee = curvature * curvature / kept.d1 - kept.u12 * s_ef;
  // Of the centre along n with w_e and w_f.
  const double s_ne = -r * (alpha * s_ee + beta * s_ef);
  const double s_nf = -r * (alpha * s_ef + beta * s_ff);
  const double of_centre = (alpha * alpha + beta * beta) * in_plane;
  const double s_nn = -r * (alpha * s_ne + beta * s_nf);

  auto& covariance = feature.covariance;
  covariance.setZero();
  const Vector3 turn_e = s_ee * e + s_ef * f;
  const Vector3 turn_f = s_ef * e + s_ff * f;
  const Vector3 turn_n = (in_plane * curvature * curvature) * n;
  const Vector3 of_turn = s_ne * e + s_nf * f;
  const Vector3 of_n = (in_plane * curvature) * (alpha * e + beta * f);
  const Vector3 of_radius = in_plane * (beta * e - alpha * f);
  for (int j = 0; j < 3; ++j) {
    covariance.col(j).head<3>() = (s_nn - of_centre) * n[j] * n;
    covariance(j, j) += of_centre + of_target;
    covariance.col(3 + j).head<3>() = n[j] * of_n + of_turn[j] * n;
    covariance.col(3 + j).segment<3>(3) = e[j] * turn_e + f[j] * turn_f + n[j] * turn_n;
    covariance.row(3 + j).head<3>() = covariance.col(3 + j).head<3>();
  }
  covariance.col(6).head<3>() = of_radius;
  covariance.row(6).head<3>() = of_radius;
  covariance(6, 6) = in_plane;
}

// The fit with the covariance of the normal equations, for all other points.
Result<Circle> take_likeliest(const MotionStatistics& statistics, const Circle& start,
                              JointFeature& feature) {
  const ConstrainedFit<Circle> fit(statistics);
  ARMSIG_TRY(fitted, fit.maximise_likelihood(start));
  const Circle& circle = fitted.motion;
  const Vector3 e = circle.R_SC.col(0);
  feature.point_S = statistics.origin_S + fit.target(circle) - circle.radius * e;
  // From the target to the centre = target - r e.
  Eigen::Matrix<double, 3, 4> moves_centre;
  moves_centre << circle.radius * cross_matrix(e), -e;
  auto& covariance = feature.covariance;
  covariance = fit.covariance(fitted);
  covariance.topRows<3>() += moves_centre.lazyProduct(covariance.bottomRows<4>());
  covariance.leftCols<3>() += covariance.rightCols<4>().lazyProduct(moves_centre.transpose());
  return circle;
}

}  // namespace

Result<void> encoder_circle(const MotionStatistics& statistics, JointFeature& feature) {
  if (statistics.motion.rank() < 3) return std::unexpected(Error::kSingular);
  const KeptFactor kept(statistics.motion);
  ARMSIG_TRY(circle, nearest_circle(kept));
  if (statistics.has_one_covariance() && is_isotropic(statistics.first_covariance_m2)) {
    take_isotropic(circle, kept, statistics.origin_S, feature);
  } else {
    ARMSIG_TRY(likeliest, take_likeliest(statistics, circle, feature));
    circle = likeliest;
  }
  feature.axis_S = circle.R_SC.col(2);
  feature.radial_S = circle.R_SC.col(0);
  feature.radius_m = circle.radius;
  return {};
}

}  // namespace armsig::features
