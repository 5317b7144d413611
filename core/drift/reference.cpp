// SPDX-License-Identifier: MIT
#include "core/drift/reference.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

#include "core/drift/check_drift.hpp"
#include "core/numerics/quantiles.hpp"

namespace armsig::drift {
namespace {

constexpr double kSigmas = 3.09;  // of a normal variable: one in a thousand lies above
// The change of the arm that may still hide in what is left is at most this share of what the rigid
// motion explains.
constexpr double kHidden = 0.5;
constexpr double kLeastSpread = 1e-6;  // of the second widest direction, over the widest

// The sum of squares about `centre` without its own direction: p^2 I - p p^T.
Matrix3 inertia(std::span<const PoseResidual> poses, const Vector3& centre) {
  Matrix3 sum = Matrix3::Zero();
  for (const PoseResidual& pose : poses) {
    const Vector3 p = pose.p_R - centre;
    sum += p.squaredNorm() * Matrix3::Identity() - p * p.transpose();
  }
  return sum;
}

}  // namespace

std::string_view describe(Moved moved) {
  switch (moved) {
    case Moved::kNothing:
      return "nothing moved";
    case Moved::kReference:
      return "the reference moved";
    case Moved::kArm:
      return "the arm changed";
    case Moved::kUndecided:
      return "undecided";
  }
  return "unknown";
}

// About the mean of the poses shift and turn part: least squares of r = t + w x p gives t as the
// mean of r, and w = I^-1 sum p x r with the inertia I of the points.
Result<ReferenceReport> what_moved(std::span<const PoseResidual> poses, double sigma_m) {
  if (poses.size() < 4) return std::unexpected(Error::kTooFewPoints);
  if (!(sigma_m > 0)) return std::unexpected(Error::kNotPositive);
  const auto n = static_cast<double>(poses.size());
  ReferenceReport report;
  Vector3 centre = Vector3::Zero();
  for (const PoseResidual& pose : poses) {
    if (!pose.p_R.allFinite() || !pose.residual_m.allFinite()) {
      return std::unexpected(Error::kNotFinite);
    }
    centre += pose.p_R / n;
    report.shift_m += pose.residual_m / n;
  }
  const Matrix3 spread = inertia(poses, centre);
  const Eigen::SelfAdjointEigenSolver<Matrix3> axes(spread);
  if (!(axes.eigenvalues()[0] > kLeastSpread * axes.eigenvalues()[2])) {
    return std::unexpected(Error::kSingular);
  }
  Vector3 moment = Vector3::Zero();
  double all = 0;
  for (const PoseResidual& pose : poses) {
    moment += (pose.p_R - centre).cross(pose.residual_m);
    all += pose.residual_m.squaredNorm();
  }
  report.turn_rad = spread.inverse() * moment;
  const double unit = sigma_m * sigma_m;
  report.explained = (n * report.shift_m.squaredNorm() + moment.dot(report.turn_rad)) / unit;
  report.left = std::max(0.0, all / unit - report.explained);
  const double freedom = 3 * n - 6;
  const bool rigid = report.explained > numerics::chi_square_quantile(6, numerics::kCheckRefused);
  const double hidden = report.left - freedom + kSigmas * std::sqrt(2 * freedom);
  if (report.left > numerics::chi_square_quantile(freedom, numerics::kCheckRefused)) {
    report.moved = Moved::kArm;
  } else if (rigid) {
    report.moved =
        hidden <= kHidden * (report.explained - 6) ? Moved::kReference : Moved::kUndecided;
  }
  return report;
}

}  // namespace armsig::drift
