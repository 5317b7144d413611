// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/calibration/engine_detail.hpp"
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
  held_out_.push_back({static_cast<float>(row.residual.squaredNorm()),
                       static_cast<float>(stated.row.trace()),
                       static_cast<float>(stated.model.trace()),
                       static_cast<float>(row.residual.dot(S.inverse() * row.residual))});
}

void HeldOutJudge::add_fitted(const Vector3& residual, const calibration::Engine::Stated& with_it) {
  const Matrix3 L = with_it.row.llt().matrixL();
  const Matrix3 whitening = L.inverse();
  // Covariance of the residual, in units of the row's own error.
  const Eigen::SelfAdjointEigenSolver<Matrix3> left(whitening * (with_it.row - with_it.model) *
                                                    whitening.transpose());
  const Vector3 unit_residual = whitening * residual;
  Vector3 error = Vector3::Zero();  // without the row
  One one;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double share = left.eigenvalues()(k);
    if (share < kLeastLeft) continue;
    const Vector3 e = left.eigenvectors().col(k);
    const Vector3 along = L * e;
    error += along * (e.dot(unit_residual) / share);
    one.row_m2 += static_cast<float>(along.squaredNorm());
    one.model_m2 += static_cast<float>(along.squaredNorm() * (1 / share - 1));
  }
  one.squares_m2 = static_cast<float>(error.squaredNorm());
  fitted_.add(one);
}

void HeldOutJudge::Sums::add(const One& one) {
  count += 1;
  squares_m2 += static_cast<double>(one.squares_m2);
  row_m2 += static_cast<double>(one.row_m2);
  model_m2 += static_cast<double>(one.model_m2);
  normalised += static_cast<double>(one.normalised);
}

HeldOutJudge::Score HeldOutJudge::score() const {
  Score score;
  score.poses = held_out_.size();
  numerics::LogHistogram lengths;
  for (const One& one : held_out_) lengths.add(static_cast<double>(one.normalised));
  const double scale = std::max(1.0, lengths.median() / numerics::kChiSquareMedian3);
  Sums sums;
  for (const One& one : held_out_) {
    const double length = static_cast<double>(one.normalised);
    // Three coordinates: the gate is for each.
    if (length > 3 * kBlunder * scale) {
      ++score.blunders;
      continue;
    }
    sums.add(one);
  }
  const double kept = std::max(sums.count, 1.0);
  score.rms_m = std::sqrt(sums.squares_m2 / kept);
  const double surprise = sums.normalised / (3 * kept);
  const double beyond_m2 = sums.squares_m2 - sums.row_m2 + fitted_.squares_m2 - fitted_.row_m2;
  const double stated_m2 = sums.model_m2 + fitted_.model_m2;
  const double shown = stated_m2 > 0 ? beyond_m2 / stated_m2 : 0;
  score.factor = std::sqrt(std::max({1.0, surprise, shown}));
  return score;
}

Motions motions_at(const calibration::ArmModel& model, const calibration::ChainFrames& frames,
                   const Vector3& p_L) {
  Motions motions;
  motions.fill(Vector3::Zero());
  const Vector3 p_S = frames.X_SL * p_L;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    motions[i] =
        calibration::motion_of(model.joints[i].type == JointType::kRevolute, frames.X_SJ[i], p_S);
  }
  return motions;
}

void Prediction::add(const calibration::Engine& engine, const calibration::ChainFrames& frames,
                     const JointVector& readings, const Covered& covered, const Motions& motions,
                     const PlayEstimate::Halves& play) {
  ++poses;
  const calibration::Engine::Stated stated = engine.covariance_at(frames, 0, {1, 0, 0, 1, 0, 1});
  model_m2 += stated.model.trace();
  for (std::size_t i = 0; i < play.size(); ++i) {
    (covered.has(i, readings[i]) ? maps_m2 : uncovered_m2)[i] += stated.maps[i];
    const double lever_m2 = motions[i].squaredNorm();
    levers_m2[i] += lever_m2;
    plays_m2[i] += play[i].squared() * lever_m2;
    play_m2 += play[i].squared() * lever_m2;
  }
}

Covered::Covered() {
  lower.fill(std::numeric_limits<double>::infinity());
  upper.fill(-std::numeric_limits<double>::infinity());
}

void Covered::add(const JointVector& readings) {
  for (std::size_t i = 0; i < readings.size(); ++i) {
    lower[i] = std::min(lower[i], readings[i]);
    upper[i] = std::max(upper[i], readings[i]);
  }
}

Budget budget_of(const Prediction& prediction, const JointTypes& types, double model_m) {
  const auto poses = static_cast<double>(prediction.poses);
  double maps_m2 = 0;
  const auto part = [&](const PerJoint& squares) {
    Budget::Part whole;
    double sum = 0;
    for (std::size_t i = 0; i < types.size(); ++i) {
      sum += squares[i];
      if (squares[i] > squares[whole.joint]) whole.joint = i;
    }
    whole.length_m = std::sqrt(sum / poses);
    whole.of_joint_m = std::sqrt(squares[whole.joint] / poses);
    return whole;
  };
  Budget budget;
  budget.maps = part(prediction.maps_m2);
  budget.uncovered = part(prediction.uncovered_m2);
  budget.play = part(prediction.plays_m2);
  for (std::size_t i = 0; i < types.size(); ++i) {
    maps_m2 += prediction.maps_m2[i] + prediction.uncovered_m2[i];
    const double lever_m = std::sqrt(prediction.levers_m2[i] / poses);
    const bool first = budget.lever_m == 0;
    if (types[i] == JointType::kRevolute && (first || lever_m < budget.lever_m)) {
      budget.lever_m = lever_m;
      budget.shortest = i;
    }
  }
  budget.geometry_m = std::sqrt(std::max(prediction.model_m2 - maps_m2, 0.0) / poses);
  budget.unexplained_m = std::sqrt(std::max(model_m * model_m - prediction.model_m2 / poses, 0.0));
  return budget;
}

double Findings::predicted_m() const { return std::hypot(model_m, play_m); }

double Findings::times_more(double accuracy_m) const {
  const double room_m2 = accuracy_m * accuracy_m - play_m * play_m;
  return room_m2 > 0 ? model_m * model_m / room_m2 : std::numeric_limits<double>::infinity();
}

}  // namespace armsig::controller
