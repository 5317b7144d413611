// SPDX-License-Identifier: MIT
#include "core/features/encoder_line.hpp"

#include "core/features/constrained_fit.hpp"

namespace armsig::features {
namespace {

// The five free parameters, as steps: point at the origin reading, turns about the two directions
// across.
struct Line {
  static constexpr int kParameters = 5;
  using Step = Eigen::Matrix<double, kParameters, 1>;

  Vector3 point;  // about the origin of the statistics
  Vector3 direction;

  [[nodiscard]] Eigen::Matrix<double, 3, 2> across() const {
    Eigen::Matrix<double, 3, 2> basis;
    basis.col(0) = any_perpendicular(direction);
    basis.col(1) = direction.cross(basis.col(0));
    return basis;
  }

  // p = point + direction t
  [[nodiscard]] MotionRls::Coefficients coefficients() const {
    MotionRls::Coefficients phi = MotionRls::Coefficients::Zero();
    phi.row(0) = point;
    phi.row(1) = direction;
    return phi;
  }

  [[nodiscard]] MotionJacobian<kParameters> jacobian() const {
    MotionJacobian<kParameters> D = MotionJacobian<kParameters>::Zero();
    D.block<3, 3>(0, 0).setIdentity();
    D.block<3, 2>(3, 3) = -cross_matrix(direction) * across();
    return D;
  }

  [[nodiscard]] Line moved(const Step& step) const {
    const Vector3 turn = across() * step.tail<2>();
    const double angle = turn.norm();
    const Vector3 turned =
        angle > 0 ? Vector3(rotation_about(turn / angle, angle) * direction) : direction;
    return {point + step.head<3>(), turned.normalized()};
  }

  [[nodiscard]] bool is_small(const Step& step) const {
    constexpr double kRounding = 1e-15;
    return step.norm() < kRounding * (1 + point.norm());
  }
};

}  // namespace

MotionRls::Coefficients LineFit::motion(const Vector3& origin_S) const {
  return Line{point_S - origin_S, direction_S}.coefficients();
}

Result<LineFit> encoder_line(const SweepStatistics& statistics) {
  const MotionRls::Coefficients phi = statistics.motion.solve();
  if (statistics.motion.rank() < 2 || !(phi.row(1).norm() > 0))
    return std::unexpected(Error::kSingular);
  const ConstrainedFit<Line> fit(statistics);
  const Line start{phi.row(0), phi.row(1).transpose().normalized()};
  ARMSIG_TRY(line, fit.maximise_likelihood(start));
  ARMSIG_TRY(covariance, fit.covariance(line));

  LineFit result;
  result.point_S = statistics.origin_S + line.point;
  result.direction_S = line.direction;
  Eigen::Matrix<double, 7, 5> spread = Eigen::Matrix<double, 7, 5>::Zero();
  spread.block<3, 3>(0, 0).setIdentity();
  spread.block<3, 2>(3, 3) = line.across();
  const Eigen::Matrix<double, 7, 5> carried = spread * covariance;
  result.covariance = carried * spread.transpose();
  return result;
}

}  // namespace armsig::features
