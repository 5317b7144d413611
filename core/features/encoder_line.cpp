// SPDX-License-Identifier: MIT
#include "core/features/constrained_fit.hpp"
#include "core/features/motion_fits.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::features {
namespace {

// The two parameters about the target, as steps: turns about the two directions across.
struct Line {
  static constexpr int kParameters = 2;
  using Step = Eigen::Matrix<double, kParameters, 1>;

  Vector3 direction;

  [[nodiscard]] Eigen::Matrix<double, 3, 2> across() const {
    Eigen::Matrix<double, 3, 2> basis;
    basis.col(0) = any_perpendicular(direction);
    basis.col(1) = direction.cross(basis.col(0));
    return basis;
  }

  // p = target + direction t
  [[nodiscard]] MotionRows rows() const {
    MotionRows rows = MotionRows::Zero();
    rows.row(0) = direction;
    return rows;
  }

  [[nodiscard]] MotionJacobian<kParameters> jacobian() const {
    MotionJacobian<kParameters> D = MotionJacobian<kParameters>::Zero();
    D.topRows<3>() = -cross_matrix(direction) * across();
    return D;
  }

  [[nodiscard]] Line moved(const Step& step) const {
    return {(numerics::rotation_by(across() * step) * direction).normalized()};
  }

  [[nodiscard]] bool is_small(const Step& step) const {
    constexpr double kSmall = 1e-12;
    return step.norm() < kSmall;
  }
};

}  // namespace

Result<void> encoder_line(const MotionStatistics& statistics, JointFeature& feature) {
  const Vector3 velocity = statistics.motion.solve().row(1);
  if (statistics.motion.rank() < 2 || !(velocity.norm() > 0))
    return std::unexpected(Error::kSingular);
  const ConstrainedFit<Line> fit(statistics);
  ARMSIG_TRY(fitted, fit.maximise_likelihood({velocity.normalized()}));
  const Line& line = fitted.motion;

  feature.point_S = statistics.origin_S + fit.target(line);
  feature.axis_S = line.direction;
  feature.radial_S = any_perpendicular(line.direction);
  feature.radius_m = 0;
  Eigen::Matrix<double, 7, 5> spread = Eigen::Matrix<double, 7, 5>::Zero();
  spread.block<3, 3>(0, 0).setIdentity();
  spread.block<3, 2>(3, 3) = line.across();
  const Eigen::Matrix<double, 7, 5> carried = spread * fit.covariance(fitted);
  feature.covariance = carried * spread.transpose();
  return {};
}

}  // namespace armsig::features
