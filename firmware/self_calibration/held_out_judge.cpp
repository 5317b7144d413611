// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/held_out_judge.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/numerics/robust.hpp"

namespace armsig::controller {
namespace {

// Of the errors' own scale, squared: none beyond it is chance.
constexpr double kBlunder = 36;
// Of a row's own variance in a direction, what the fit leaves in its residual. Where less is left,
// the least bend of the model counts many times.
constexpr double kLeastLeft = 0.1;

}  // namespace

void HeldOutJudge::add(const calibration::Engine& engine, const calibration::FitRow& row,
                       const calibration::ChainFrames& frames) {
  const calibration::Engine::Stated stated = engine.covariance_of(row, frames);
  const Matrix3 S = stated.row + stated.model;
  held_out_.push_back(
      {.error = {.all_m2 = static_cast<float>(row.residual.squaredNorm()),
                 .row_m2 = static_cast<float>(stated.row.trace()),
                 .model_m2 = static_cast<float>(stated.model.trace())},
       .normalised = static_cast<float>(row.residual.dot(S.inverse() * row.residual))});
}

void HeldOutJudge::add_fitted(const Vector3& residual, const calibration::Engine::Stated& with_it) {
  const Matrix3 L = with_it.row.llt().matrixL();
  const Matrix3 whitening = L.inverse();
  // Covariance of the residual, in units of the row's own error.
  const Eigen::SelfAdjointEigenSolver<Matrix3> left(whitening * (with_it.row - with_it.model) *
                                                    whitening.transpose());
  const Vector3 unit_residual = whitening * residual;
  Vector3 error = Vector3::Zero();  // without the row
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double share = left.eigenvalues()(k);
    if (share < kLeastLeft) continue;
    const Vector3 e = left.eigenvectors().col(k);
    const Vector3 along = L * e;
    error += along * (e.dot(unit_residual) / share);
    fitted_.row_m2 += along.squaredNorm();
    fitted_.model_m2 += along.squaredNorm() * (1 / share - 1);
  }
  fitted_.all_m2 += error.squaredNorm();
}

HeldOutJudge::Score HeldOutJudge::score() const {
  Score score;
  score.poses = held_out_.size();
  numerics::LogHistogram lengths;
  for (const HeldOut& pose : held_out_) lengths.add(static_cast<double>(pose.normalised));
  const double scale = std::max(1.0, lengths.median() / numerics::kChiSquareMedian3);
  Squares<double> sums;
  double normalised = 0;
  for (const auto& [error, pose_normalised] : held_out_) {
    const auto length = static_cast<double>(pose_normalised);
    // Three coordinates: the gate is for each.
    if (length > 3 * kBlunder * scale) {
      ++score.blunders;
      continue;
    }
    normalised += length;
    sums.all_m2 += static_cast<double>(error.all_m2);
    sums.row_m2 += static_cast<double>(error.row_m2);
    sums.model_m2 += static_cast<double>(error.model_m2);
  }
  const double kept = std::max(static_cast<double>(score.poses - score.blunders), 1.0);
  score.rms_m = std::sqrt(sums.all_m2 / kept);
  const double surprise = normalised / (3 * kept);
  const double beyond_m2 = sums.all_m2 - sums.row_m2 + fitted_.all_m2 - fitted_.row_m2;
  const double stated_m2 = sums.model_m2 + fitted_.model_m2;
  const double shown = stated_m2 > 0 ? beyond_m2 / stated_m2 : 0;
  score.factor = std::sqrt(std::max({1.0, surprise, shown}));
  return score;
}

}  // namespace armsig::controller
