// SPDX-License-Identifier: MIT
#include "core/measurement/receivers.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>

namespace armsig::measurement {

Spread spread_of(const Points& points) {
  ARMSIG_CHECK(!points.empty());
  const double weight = 1.0 / static_cast<double>(points.size());
  Spread spread;
  for (const Vector3& p : points) spread.centroid += weight * p;
  Matrix3 moments = Matrix3::Zero();
  for (const Vector3& p : points) {
    const Vector3 u = p - spread.centroid;
    moments += weight * u * u.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(moments);  // eigenvalues rise
  spread.axes = eigen.eigenvectors().rowwise().reverse();
  spread.rms = eigen.eigenvalues().reverse().cwiseMax(0.0).cwiseSqrt();
  return spread;
}

Result<void> check(const ReceiverArray& array) {
  for (const Vector3& p : array.p_S)
    if (!p.allFinite()) return std::unexpected(Error::kNotFinite);
  if (!std::isfinite(array.range_sigma_m)) return std::unexpected(Error::kNotFinite);
  if (!array.facing_S.allFinite()) return std::unexpected(Error::kNotFinite);
  if (array.range_sigma_m <= 0) return std::unexpected(Error::kNotPositive);
  if (array.p_S.size() < 3) return std::unexpected(Error::kTooFewReceivers);

  const Spread spread = spread_of(array.p_S);
  if (spread.on_a_line()) return std::unexpected(Error::kReceiversCollinear);
  if (spread.in_a_plane()) {
    const Vector3 normal = spread.axes.col(2);
    const bool tells_sides =
        std::abs(array.facing_S.dot(normal)) > Spread::kFlat * array.facing_S.norm();
    if (!tells_sides) return std::unexpected(Error::kMirrorAmbiguity);
  }
  return {};
}

}  // namespace armsig::measurement
