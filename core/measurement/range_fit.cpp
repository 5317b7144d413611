// SPDX-License-Identifier: MIT
#include "core/measurement/range_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/measurement/receivers.hpp"

namespace armsig::measurement {

namespace {

constexpr int kMaxIterations = 50;
// A step that promises to lower chi-square by less than this is a hundred-millionth of a sigma.
constexpr double kNegligible = 1e-16;
// A step this small, of the distances at play, is rounding. Comes first where sigma is next to
// nothing.
constexpr double kRounding = 1e-13;
constexpr double kMaxCurvature = 0.1;
// No number of ranges is consistent at such a chi-square. Where Gauss-Newton doesn't promise to
// lower it by a tenth, the ranges contradict each other, or the search crawls along a valley that
// leads from the mirror image to the point that the other search starts from.
constexpr double kHopeless = 1e3;
constexpr double kCrawling = 0.1;
// Two fits are the same point if they differ by less than a thousandth of a sigma.
constexpr double kSamePoint = 1e-6;

// Chi-square at a point, with its Gauss-Newton normal equations H step = g.
struct Normal {
  double chi_square = 0;
  Matrix3 H = Matrix3::Zero();
  Vector3 g = Vector3::Zero();
};

Normal normal_equations(const Spheres& spheres, const Vector3& p_S) {
  Normal normal;
  for (const Sphere& sphere : spheres) {
    const Vector3 offset = p_S - sphere.centre_S;
    const double distance = offset.norm();
    const double residual = (sphere.radius_m - distance) / sphere.sigma_m;
    normal.chi_square += residual * residual;
    if (distance == 0) continue;  // on the receiver: the range has no direction there
    const Vector3 row = offset / (distance * sphere.sigma_m);
    normal.H += row * row.transpose();
    normal.g += row * residual;
  }
  return normal;
}

// On either side of the plane.
std::array<Vector3, 2> linear_starts(const Spheres& spheres) {
  Points centres;
  for (const Sphere& sphere : spheres) centres.push_back(sphere.centre_S);
  const Spread spread = spread_of(centres);

  // With u the receivers and x the point, both from the centroid: |u|^2 - r^2 = 2 u.x - |x|^2. The
  // u sum to zero and their products along different principal axes too, so that the means of
  // (|u|^2 - r^2) times the components of u give x one component at a time.
  const double weight = 1.0 / static_cast<double>(spheres.size());
  Vector3 moment = Vector3::Zero();
  double distance_squared = 0;
  for (const Sphere& sphere : spheres) {
    const Vector3 u = spread.axes.transpose() * (sphere.centre_S - spread.centroid);
    const double difference = u.squaredNorm() - sphere.radius_m * sphere.radius_m;
    moment += 0.5 * weight * difference * u;
    distance_squared -= weight * difference;
  }
  Vector3 x = Vector3::Zero();
  x(0) = moment(0) / (spread.rms(0) * spread.rms(0));
  if (!spread.on_a_line()) x(1) = moment(1) / (spread.rms(1) * spread.rms(1));
  // Off the plane in any case: on the plane of a flat array chi-square has no slope across it.
  const double least_height = 0.01 * spread.rms(0);
  const double height_squared = distance_squared - x.squaredNorm();
  x(2) = std::sqrt(std::max(height_squared, least_height * least_height));
  const Vector3 above_S = spread.centroid + spread.axes * x;
  x(2) = -x(2);
  return {above_S, spread.centroid + spread.axes * x};
}

PointFit descend(const Spheres& spheres, const Vector3& start_S) {
  PointFit fit{.p_S = start_S};
  Normal here = normal_equations(spheres, fit.p_S);
  bool converged = false;
  double damping = 0;
  for (int i = 0; i < kMaxIterations && !converged; ++i) {
    const Matrix3 damped = here.H + damping * here.H.trace() * Matrix3::Identity();
    const Vector3 step = damped.ldlt().solve(here.g);
    const double promise = step.dot(here.g);
    const bool crawling = damping == 0 && promise < kCrawling * here.chi_square;
    if (crawling && here.chi_square > kHopeless) break;
    const Normal there = normal_equations(spheres, fit.p_S + step);
    const double distances = fit.p_S.norm() + std::abs(spheres[0].radius_m);
    converged = std::abs(promise) < kNegligible || step.norm() < kRounding * distances;
    // Not finite compares false: more damping then.
    if (converged || there.chi_square < here.chi_square) {
      if (there.chi_square <= here.chi_square) {
        fit.p_S += step;
        here = there;
      }
      damping = damping < 1e-9 ? 0 : 0.1 * damping;
    } else {
      damping = std::max(1e-6, 10 * damping);
    }
  }
  fit.chi_square = here.chi_square;

  double nearest = std::numeric_limits<double>::infinity();
  double finest_sigma = spheres[0].sigma_m;
  for (const Sphere& sphere : spheres) {
    nearest = std::min(nearest, (fit.p_S - sphere.centre_S).norm());
    finest_sigma = std::min(finest_sigma, sphere.sigma_m);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(here.H, Eigen::EigenvaluesOnly);
  const double information = eigen.eigenvalues()(0);  // in the worst direction, 1 / m^2
  fit.determined = converged && information * kMaxCurvature * nearest * finest_sigma >= 1;
  if (fit.determined) fit.covariance_m2 = here.H.inverse();
  return fit;
}

bool same_point(const PointFit& a, const PointFit& b) {
  const Vector3 difference = a.p_S - b.p_S;
  return a.determined && b.determined &&
         difference.squaredNorm() <= kSamePoint * a.covariance_m2.trace();
}

}  // namespace

FixedVector<PointFit, 2> fit_point(const Spheres& spheres) {
  ARMSIG_CHECK(spheres.size() >= 3);
  FixedVector<PointFit, 2> fits;
  for (const Vector3& start_S : linear_starts(spheres)) {
    const PointFit fit = descend(spheres, start_S);
    if (fits.empty() || !same_point(fits[0], fit)) fits.push_back(fit);
  }
  return fits;
}

}  // namespace armsig::measurement
