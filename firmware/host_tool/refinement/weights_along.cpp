// SPDX-License-Identifier: MIT
#include "firmware/host_tool/refinement/weights_along.hpp"

#include <Eigen/Cholesky>

namespace armsig::tool {
namespace {

// 1 sigma of a coefficient beforehand: a joint of a soft arm, a metre from a link's origin.
constexpr double kCoefficient = 0.01;
// By turns, from each axis: what is bilinear converges linearly, and needs no more digits here.
constexpr int kTurns = 40;

// Three rows a coefficient.
Eigen::MatrixXd along(const Vector3& up_0, Eigen::Index terms) {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(3 * terms, terms);
  for (Eigen::Index t = 0; t < terms; ++t) all.block<3, 1>(3 * t, t) = up_0;
  return all;
}

}  // namespace

WeightsAlong::WeightsAlong(Eigen::MatrixXd own, Eigen::VectorXd score, double variance)
    : own_(std::move(own)), score_(std::move(score)) {
  own_.diagonal().array() += variance / (kCoefficient * kCoefficient);
}

Eigen::VectorXd WeightsAlong::coefficients(const Vector3& up_0) const {
  const Eigen::MatrixXd all = along(up_0, score_.size() / 3);
  return (all.transpose() * own_ * all).ldlt().solve(all.transpose() * score_);
}

double WeightsAlong::gain(const Vector3& up_0) const {
  const Eigen::MatrixXd all = along(up_0, score_.size() / 3);
  return coefficients(up_0).dot(all.transpose() * score_);
}

// The vertical for the coefficients that suit this one.
Vector3 WeightsAlong::better(const Vector3& up_0) const {
  const Eigen::VectorXd c = coefficients(up_0);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(score_.size(), 3);
  for (Eigen::Index t = 0; t < c.size(); ++t)
    all.block<3, 3>(3 * t, 0).diagonal().setConstant(c[t]);
  const Matrix3 H = all.transpose() * own_ * all;
  const Vector3 next = H.ldlt().solve(all.transpose() * score_);
  return next.norm() > 0 ? Vector3(next.normalized()) : up_0;
}

// How far the residuals go with the deflections of equal joints under equal weights. Single
// coefficients are not to be trusted so far: those of neighbouring origins may be of either sign.
double WeightsAlong::gives_way(const Vector3& up_0) const {
  return (along(up_0, score_.size() / 3).transpose() * score_).sum();
}

std::pair<Vector3, double> WeightsAlong::best() const {
  std::pair<Vector3, double> best{Vector3::UnitZ(), 0};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    Vector3 up_0 = Vector3::Unit(axis);
    for (int turn = 0; turn < kTurns; ++turn) up_0 = better(up_0);
    if (const double gained = gain(up_0); gained > best.second) best = {up_0, gained};
  }
  if (gives_way(best.first) < 0) best.first = -best.first;
  return best;
}

}  // namespace armsig::tool
