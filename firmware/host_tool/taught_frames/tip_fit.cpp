// SPDX-License-Identifier: MIT
#include "firmware/host_tool/taught_frames/tip_fit.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "core/numerics/rotations.hpp"

namespace armsig::tool {
namespace {

// A of A (t_E, tip_C) = -p.
Eigen::MatrixXd tip_rows(const std::vector<Pose>& X_CE) {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(3 * X_CE.size()), 6);
  for (std::size_t k = 0; k < X_CE.size(); ++k) {
    rows.middleRows<3>(static_cast<Eigen::Index>(3 * k)) << X_CE[k].R, -Matrix3::Identity();
  }
  return rows;
}

}  // namespace

double TipFit::residual_squares() const {
  double squares = 0;
  for (const Vector3& residual : residuals_C) squares += residual.squaredNorm();
  return squares;
}

LeastTurned least_turned(const std::vector<Pose>& X_CE) {
  Matrix3 mean = Matrix3::Zero();
  for (const Pose& X : X_CE) mean += X.R / static_cast<double>(X_CE.size());
  Matrix3 spread = Matrix3::Zero();
  for (const Pose& X : X_CE) spread += (X.R - mean).transpose() * (X.R - mean);
  LeastTurned least;
  least.direction_E = Eigen::SelfAdjointEigenSolver<Matrix3>(spread).eigenvectors().col(0);
  for (std::size_t i = 0; i < X_CE.size(); ++i) {
    for (std::size_t j = i + 1; j < X_CE.size(); ++j) {
      least.angle_rad = std::max(
          least.angle_rad,
          numerics::angle_between(X_CE[i].R * least.direction_E, X_CE[j].R * least.direction_E));
    }
  }
  return least;
}

TipFit fit_tip(const std::vector<Pose>& X_CE) {
  const auto poses = static_cast<Eigen::Index>(X_CE.size());
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(tip_rows(X_CE));
  Eigen::VectorXd p(3 * poses);
  for (Eigen::Index k = 0; k < poses; ++k) {
    p.segment<3>(3 * k) = X_CE[static_cast<std::size_t>(k)].p;
  }
  const Eigen::VectorXd found = solver.solve(-p);
  TipFit fit;
  fit.t_E = found.head<3>();
  fit.tip_C = found.tail<3>();
  Eigen::MatrixXd by_poses = Eigen::MatrixXd::Zero(3 * poses, 6 * poses);
  for (Eigen::Index k = 0; k < poses; ++k) {
    const Pose& X = X_CE[static_cast<std::size_t>(k)];
    fit.residuals_C.emplace_back(X * fit.t_E - fit.tip_C);
    by_poses.block<3, 3>(3 * k, 6 * k) = Matrix3::Identity();
    by_poses.block<3, 3>(3 * k, 6 * k + 3) = -cross_matrix(X.R * fit.t_E);
  }
  fit.by_poses = solver.solve(-by_poses);
  return fit;
}

}  // namespace armsig::tool
