// SPDX-License-Identifier: MIT
// The same circle by Ceres.
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include <cmath>
#include <cstdlib>

#include "host_tests/benchmarks/estimators_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {
namespace {

// Seven unknowns: centre, rotation vector of the frame about the start's, radius.
struct CircleResidual {
  Matrix3 R_start;
  double cosine;
  double sine;
  Vector3 p_S;

  template <typename T>
  bool operator()(const T* circle, T* residual) const {
    const T p_C[3] = {circle[6] * cosine, circle[6] * sine, T(0)};
    T p_turned[3];
    ceres::AngleAxisRotatePoint(circle + 3, p_C, p_turned);
    for (int r = 0; r < 3; ++r) {
      T predicted = circle[r];
      for (int c = 0; c < 3; ++c) predicted += R_start(r, c) * p_turned[c];
      residual[r] = predicted - p_S[r];
    }
    return true;
  }
};

// From a start one degree and a centimetre away.
Eigen::Matrix<double, 7, 1> circle_by_ceres(const CircleWork& work,
                                            const features::CircleFit& near) {
  Eigen::Matrix<double, 7, 1> circle;
  circle << near.centre_S + Vector3(0.01, 0, 0), Vector3(radians(1), 0, 0), near.radius_m + 0.01;
  ceres::Problem problem;
  for (const features::SweepPoint& point : work.points) {
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<CircleResidual, 3, 7>(new CircleResidual{
            near.R_SC, std::cos(point.reading), std::sin(point.reading), point.p_S}),
        nullptr, circle.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.function_tolerance = 1e-12;  // at Ceres' own 1e-6 the answer is a micrometre off
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable()) std::abort();
  return circle;
}

struct CircleRows {
  CircleRows() {
    for (const std::size_t points : kCirclePoints) {
      const Row row(
          circle_path(points), "Ceres",
          [points] {
            return [work = circle_work(points)](std::size_t calls) {
              const features::CircleFit own = circle_of(work);
              for (std::size_t k = 0; k < calls; ++k) {
                const Eigen::Matrix<double, 7, 1> circle = circle_by_ceres(work, own);
                if ((circle.head<3>() - own.centre_S).norm() > 1e-9) std::abort();
                if (std::abs(circle[6] - own.radius_m) > 1e-9) std::abort();
                keep(circle);
              }
            };
          },
          1);
    }
  }
};
const CircleRows kCircleRows;

}  // namespace
}  // namespace armsig::benchmarks
