// SPDX-License-Identifier: MIT
// The same circle by Ceres, in two forms. "Ceres, fit alone": all points in one residual block with
// an analytic Jacobian, its fastest, which neither gates nor states a covariance. "Ceres": a block
// a point with an analytic Jacobian, so that its own robust loss can stand where ours gates, and
// the covariance.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>
#include <cstdlib>
#include <span>
#include <vector>

#include "core/features/gate.hpp"
#include "host_tests/benchmarks/estimators_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

// Seven unknowns: centre, turn of the frame about the start's, radius. In sigmas.
class CircleResiduals final : public ceres::CostFunction {
 public:
  CircleResiduals(const Matrix3& R_start, std::span<const features::SweepPoint> points)
      : R_start_(R_start), points_(points.begin(), points.end()) {
    set_num_residuals(3 * static_cast<int>(points.size()));
    *mutable_parameter_block_sizes() = {7};
    for (const features::SweepPoint& point : points)
      directions_.push_back({std::cos(point.reading), std::sin(point.reading), 0});
  }

  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    using RowMajor = Eigen::Matrix<double, 3, 7, Eigen::RowMajor>;
    constexpr double kWeight = 1 / kSweepSigma_m;
    const double* circle = parameters[0];
    const Eigen::Map<const Vector3> centre(circle);
    const Eigen::Map<const Vector3> turn(circle + 3);
    const double angle = turn.norm();
    const Vector3 axis = angle > 0 ? Vector3(turn / angle) : Vector3::UnitX();
    const Matrix3 R = rotation_about(axis, angle);
    // The left Jacobian of the exponential: R(turn + d) = R(J d) R(turn).
    const double half = angle > 1e-8 ? (1 - std::cos(angle)) / (angle * angle) : 0.5;
    const double rest = angle > 1e-8 ? (angle - std::sin(angle)) / (angle * angle * angle) : 0;
    const Matrix3 K = cross_matrix(turn);
    const Matrix3 J = Matrix3::Identity() + half * K + rest * K * K;
    const Matrix3 R_SC = R_start_ * R;
    const Matrix3 R_J = R_start_ * J;
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Vector3 direction = R_SC * directions_[k];
      const Vector3 residual = centre + circle[6] * direction - points_[k].p_S;
      Eigen::Map<Vector3>(residuals + 3 * k) = kWeight * residual;
      if (jacobians == nullptr || jacobians[0] == nullptr) continue;
      Eigen::Map<RowMajor> D(jacobians[0] + 21 * k);
      D.leftCols<3>() = kWeight * Matrix3::Identity();
      D.middleCols<3>(3) = (-kWeight * circle[6]) * (cross_matrix(direction) * R_J);
      D.col(6) = kWeight * direction;
    }
    return true;
  }

 private:
  Matrix3 R_start_;
  std::vector<features::SweepPoint> points_;
  std::vector<Vector3> directions_;
};

using Unknowns = Eigen::Matrix<double, 7, 1>;

void solve(ceres::Problem& problem) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-12;  // at Ceres' own 1e-6 the answer is a micrometre off
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
}

void fit_alone(const std::vector<features::SweepPoint>& sweep, const Matrix3& R_start,
               Unknowns& circle) {
  ceres::Problem problem;
  problem.AddResidualBlock(new CircleResiduals(R_start, sweep), nullptr, circle.data());
  solve(problem);
}

void gate_and_fit(const std::vector<features::SweepPoint>& sweep, const Matrix3& R_start,
                  Unknowns& circle) {
  ceres::Problem problem;
  for (const features::SweepPoint& point : sweep) {
    problem.AddResidualBlock(new CircleResiduals(R_start, {&point, 1}),
                             new ceres::HuberLoss(std::sqrt(features::kGateChiSquare)),
                             circle.data());
  }
  solve(problem);
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  const std::vector<const double*> unknowns = {circle.data()};
  if (!covariance.Compute(unknowns, &problem)) std::abort();
  Eigen::Matrix<double, 7, 7, Eigen::RowMajor> of_circle;
  covariance.GetCovarianceBlock(circle.data(), circle.data(), of_circle.data());
  keep(of_circle);
}

using Fit = void (*)(const std::vector<features::SweepPoint>&, const Matrix3&, Unknowns&);

// From a start one degree and a centimetre away, to the same answer.
struct SweepRows {
  SweepRows() {
    for (const std::size_t points : kSweepPoints) {
      add(points, "Ceres", gate_and_fit);
      add(points, "Ceres, fit alone", fit_alone);
    }
  }
  static void add(std::size_t points, const char* who, Fit fit) {
    const Row row(
        sweep_path(points), who,
        [points, fit] {
          return [sweep = sweep_of(points), fit](std::size_t calls) {
            const features::JointFeature own = feature_of(sweep);
            Matrix3 R_start;
            R_start << own.radial_S, own.axis_S.cross(own.radial_S), own.axis_S;
            R_start = R_start * rotation_about(Vector3::UnitZ(), -own.reference_reading);
            for (std::size_t k = 0; k < calls; ++k) {
              Unknowns circle;
              circle << own.point_S + Vector3(0.01, 0, 0), Vector3(radians(1), 0, 0),
                  own.radius_m + 0.01;
              fit(sweep, R_start, circle);
              if ((circle.head<3>() - own.point_S).norm() > 1e-9) std::abort();
              if (std::abs(circle[6] - own.radius_m) > 1e-9) std::abort();
              keep(circle);
            }
          };
        },
        1);
  }
};
const SweepRows kSweepRows;

}  // namespace
}  // namespace armsig::benchmarks
