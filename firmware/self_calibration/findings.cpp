// SPDX-License-Identifier: MIT
#include "firmware/self_calibration/findings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>

#include "core/calibration/engine_detail.hpp"
#include "core/numerics/robust.hpp"

namespace armsig::controller {
namespace {

// Of the errors' own scale, squared: none beyond it is chance.
constexpr double kBlunder = 36;

}  // namespace

void HeldOutJudge::add(const calibration::Engine& engine, const calibration::FitRow& row,
                       const calibration::ChainFrames& frames) {
  const calibration::Engine::Stated stated = engine.covariance_of(row, frames);
  const Matrix3 S = stated.row + stated.model;
  held_out_.push_back({static_cast<float>(row.residual.squaredNorm()),
                       static_cast<float>(stated.row.trace()),
                       static_cast<float>(row.residual.dot(S.inverse() * row.residual))});
}

HeldOutJudge::Score HeldOutJudge::score() const {
  Score score;
  score.poses = held_out_.size();
  if (held_out_.empty()) return score;
  numerics::LogHistogram lengths;
  for (const One& one : held_out_) lengths.add(static_cast<double>(one.normalised));
  const double scale = std::max(1.0, lengths.median() / numerics::kChiSquareMedian3);
  double squares = 0;
  double rows = 0;
  double normalised = 0;
  for (const One& one : held_out_) {
    const double length = static_cast<double>(one.normalised);
    // Three coordinates: the gate is for each.
    if (length > 3 * kBlunder * scale) {
      ++score.blunders;
      continue;
    }
    squares += static_cast<double>(one.squares_m2);
    rows += static_cast<double>(one.row_m2);
    normalised += length;
  }
  const auto kept = static_cast<double>(score.poses - score.blunders);
  score.rms_m = std::sqrt(squares / kept);
  score.beyond_m = std::sqrt(std::max(squares - rows, 0.0) / kept);
  score.factor = std::sqrt(std::max(1.0, normalised / (3 * kept)));
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
                     const Motions& motions, const PlayEstimate::Halves& play) {
  ++poses;
  model_m2 += engine.covariance_at(frames, 0, {1, 0, 0, 1, 0, 1}).model.trace();
  for (std::size_t i = 0; i < play.size(); ++i) {
    play_m2 += play[i].squared() * motions[i].squaredNorm();
  }
}

double Findings::predicted_m() const { return std::hypot(model_m, play_m); }

double Findings::times_more(double accuracy_m) const {
  const double room_m2 = accuracy_m * accuracy_m - play_m * play_m;
  return room_m2 > 0 ? model_m * model_m / room_m2 : std::numeric_limits<double>::infinity();
}

}  // namespace armsig::controller
