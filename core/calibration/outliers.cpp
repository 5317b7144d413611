// SPDX-License-Identifier: MIT
// Which rows are blunders (section 9 of ALGORITHMS): by the residuals' own scale, never by a stated
// one; and never a pose at which every target deviates alike, for that is the arm.
#include <algorithm>
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"
#include "core/refinement/robust.hpp"

namespace armsig::calibration {

namespace {

// The median length of three normal coordinates, and of one, in sigma.
constexpr double kMedianLength3 = 1.538;
constexpr double kMedianLength1 = 0.6745;
// Of the soft weight at the start, and of rejection: in robust sigma.
constexpr double kSoft = 4;
constexpr double kFiner = 0.25;  // of the scale of soft weights, in a round
constexpr double kGate = 6;
constexpr std::size_t kMostTogether = 64;  // rows of a pose judged together

}  // namespace

double Engine::residual_scale() const {
  refinement::LogHistogram lengths;
  double count = 0;
  for (const FitRow& row : rows_) {
    if (row.held_out) continue;
    lengths.add(std::sqrt(whitened_squares(row)) /
                (row.is_range() ? kMedianLength1 : kMedianLength3));
    count += static_cast<double>(row.scalars());
  }
  const double freedom = std::max(count - effective_, 0.05 * count);
  return std::max(std::sqrt(kLeastVariance), lengths.median() * std::sqrt(count / freedom));
}

double Engine::rms_scale() const {
  double squares = 0;
  double scalars = 0;
  for (const FitRow& row : rows_) {
    if (row.held_out) continue;
    squares += whitened_squares(row);
    scalars += static_cast<double>(row.scalars());
  }
  return std::sqrt(squares / scalars);
}

// From coarse to fine: a sweep that the start misses by far must not be given up before the fit has
// come near it (graduated non-convexity: Blake and Zisserman, Visual Reconstruction, 1987).
void Engine::weigh_softly() {
  const double own = residual_scale();
  if (!(coarse_ > 0)) coarse_ = rms_scale();
  const double scale = std::max(own, coarse_);
  coarse_ *= kFiner;
  for (FitRow& row : rows_) {
    const double share = std::sqrt(whitened_squares(row)) / (kSoft * scale);
    row.weight = 1 / ((1 + share * share) * (1 + share * share));
  }
}

// What the residuals of a pose have in common: the point from which the sum of their lengths is
// least, by weighted means.
Vector3 Engine::common_residual(std::span<const FitRow> pose, double gate) const {
  constexpr int kPasses = 30;
  // Of the gate: nearer residuals weigh the same, and directions that nobody measured stay put.
  constexpr double kNear = 1e-3;
  constexpr double kFirm = 1e-6;
  Vector3 common = Vector3::Zero();
  for (int pass = 0; pass < kPasses; ++pass) {
    Matrix3 weights = kFirm / gate * Matrix3::Identity();
    Vector3 sum = Vector3::Zero();
    for (const FitRow& row : pose) {
      FitRow shifted = row;
      shifted.residual -= common;
      const double length = pass == 0 ? gate : std::sqrt(whitened_squares(shifted));
      const Matrix3 W = precision(row) / std::max(length, kNear * gate);
      weights += W;
      sum += W * row.residual;
    }
    common = weights.inverse() * sum;
  }
  return common;
}

// The rows of one pose, residuals judged about what they have in common where most of them lie far
// out.
void Engine::judge_pose(std::span<FitRow> pose, double gate) {
  std::size_t far = 0;
  bool several = false;
  for (FitRow& row : pose) {
    row.weight = whitened_squares(row) <= gate * gate ? 1 : 0;
    if (row.weight == 0) ++far;
    several = several || row.target != pose.front().target;
  }
  if (!several || 2 * far <= pose.size() || pose.size() > kMostTogether) return;
  const Vector3 common = common_residual(pose, gate);
  for (FitRow& row : pose) {
    FitRow shifted = row;
    shifted.residual -= common;
    row.weight = whitened_squares(shifted) <= gate * gate ? 1 : 0;
  }
}

void Engine::reject() {
  const double gate = kGate * residual_scale();
  for (std::size_t k = 0; k < rows_.size();) {
    std::size_t end = k;
    while (end < rows_.size() && rows_[end].pose == rows_[k].pose) ++end;
    judge_pose(rows_.subspan(k, end - k), gate);
    k = end;
  }
  summary_.rejected = 0;
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    std::size_t left = 0;
    for (const FitRow& row : rows_) left += !row.held_out && row.target == t && row.weight > 0;
    if (left > 0) continue;
    for (FitRow& row : rows_) {
      if (row.target == t) row.weight = 1;
    }
  }
  for (const FitRow& row : rows_) summary_.rejected += !row.held_out && row.weight == 0;
}

}  // namespace armsig::calibration
