// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/left_out.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace armsig::controller {
namespace {

// Of a row's own variance, what the fit leaves in its residual.
constexpr double kLeastLeft = 0.2;

}  // namespace

std::optional<LeftOut> left_out(const Vector3& residual,
                                const calibration::Engine::Stated& with_it) {
  const Eigen::LLT<Matrix3> row(with_it.row);
  const auto L = row.matrixL();
  // What the fit leaves, by units of the row's own error.
  const Matrix3 half = L.solve(Matrix3(with_it.row - with_it.model));
  const Matrix3 left = L.solve(Matrix3(half.transpose()));
  const Eigen::SelfAdjointEigenSolver<Matrix3> directions(left);
  const Vector3 unit_residual = L.solve(residual);
  LeftOut result;
  bool tells = false;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double share = directions.eigenvalues()(k);
    if (share < kLeastLeft) continue;
    tells = true;
    const Vector3 e = directions.eigenvectors().col(k);
    const Vector3 along = L * e;
    const Vector3 across = L.transpose().solve(e);
    result.error_m += along * (e.dot(unit_residual) / share);
    result.row_m2 += along * along.transpose();
    result.covariance_m2 += along * along.transpose() / share;
    result.information += share * across * across.transpose();
  }
  return tells ? std::optional(result) : std::nullopt;
}

}  // namespace armsig::controller
