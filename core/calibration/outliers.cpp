// SPDX-License-Identifier: MIT
// Which rows are blunders (docs/model.md, section 9): by the residuals' own scale, never by a
// stated one; and never a pose at which every target deviates alike, for that is the arm.
#include <algorithm>
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/calibration/engine_detail.hpp"

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

// By how much the mean square length of merged rows exceeds what half of them are below: their
// scatter is normal, what they have in common is not.
[[maybe_unused]] double beyond_median(const FitRow& row) {
  constexpr double kShare = 1 - kMedianLength3 * kMedianLength3 / 3;
  return kShare * row.merged.scatter_m2 / row.merged.count;
}

}  // namespace

void Engine::add_lengths(Units rows) {
  if (rows.first == 0) {
    work_.lengths = {};
    sums_ = {};
  }
  for (const FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (row.held_out) continue;
    double squares = mean_squares(row);
    if constexpr (kMergesRows) squares -= beyond_median(row);
    work_.lengths.add(std::sqrt(squares) / (row.is_range() ? kMedianLength1 : kMedianLength3),
                      row.merged.count);
    sums_.weights += static_cast<double>(row.scalars());
  }
}

void Engine::conclude_lengths() {
  const double count = sums_.weights;
  const double freedom = std::max(count - effective_, 0.05 * count);
  scale_ = std::max(std::sqrt(kLeastVariance), work_.lengths.median() * std::sqrt(count / freedom));
}

void Engine::add_squares(Units rows) {
  if (rows.first == 0) sums_ = {};
  for (const FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (row.held_out) continue;
    sums_.squares += whitened_squares(row);
    sums_.weights += static_cast<double>(row.scalars());
  }
}

void Engine::conclude_coarse() { coarse_ = std::sqrt(sums_.squares / sums_.weights); }

// From coarse to fine: a sweep that the start misses by far must not be given up before the fit has
// come near it (graduated non-convexity: Blake and Zisserman, Visual Reconstruction, 1987).
void Engine::begin_soft_weights() {
  soft_scale_ = std::max(scale_, coarse_);
  coarse_ *= kFiner;
  agenda_.put({of_rows(&Engine::weigh_softly, kLook)});
}

void Engine::weigh_softly(Units rows) {
  for (FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    const double share = std::sqrt(mean_squares(row)) / (kSoft * soft_scale_);
    row.weight = 1 / ((1 + share * share) * (1 + share * share));
  }
}

// What the residuals of a pose have in common: the point from which the sum of their lengths is
// least, by weighted means.
Vector3 Engine::common_residual(std::span<const FitRow> pose) const {
  constexpr int kPasses = 30;
  // Of the gate: nearer residuals weigh the same, and directions that nobody measured stay put.
  constexpr double kNear = 1e-3;
  constexpr double kFirm = 1e-6;
  Vector3 common = Vector3::Zero();
  for (int pass = 0; pass < kPasses; ++pass) {
    Matrix3 weights = kFirm / gate_ * Matrix3::Identity();
    Vector3 sum = Vector3::Zero();
    for (const FitRow& row : pose) {
      FitRow shifted = row;
      shifted.residual -= common;
      const double length = pass == 0 ? gate_ : std::sqrt(mean_squares(shifted));
      const Matrix3 W = precision(row) / std::max(length, kNear * gate_);
      weights += W;
      sum += W * row.residual;
    }
    common = weights.inverse() * sum;
  }
  return common;
}

// The rows of one pose, residuals judged about what they have in common where most of them lie far
// out.
void Engine::judge_pose(std::span<FitRow> pose) {
  std::size_t far = 0;
  bool several = false;
  for (FitRow& row : pose) {
    row.weight = mean_squares(row) <= gate_ * gate_ ? 1 : 0;
    if (row.weight == 0) ++far;
    several = several || row.target != pose.front().target;
  }
  if (!several || 2 * far <= pose.size() || pose.size() > kMostTogether) return;
  const Vector3 common = common_residual(pose);
  for (FitRow& row : pose) {
    FitRow shifted = row;
    shifted.residual -= common;
    row.weight = mean_squares(shifted) <= gate_ * gate_ ? 1 : 0;
  }
}

void Engine::begin_rejection() {
  gate_ = kGate * scale_;
  agenda_.put({of_rows(&Engine::judge_poses, kLook), of_rows(&Engine::count_kept, 1),
               of_rows(&Engine::keep_targets, 1)});
}

// The poses whose first row is among these.
void Engine::judge_poses(Units rows) {
  for (std::size_t k = rows.first; k < rows.last;) {
    const bool first = k == 0 || rows_[k - 1].pose != rows_[k].pose;
    std::size_t end = k;
    while (end < rows_.size() && rows_[end].pose == rows_[k].pose) ++end;
    if (first) judge_pose(rows_.subspan(k, end - k));
    k = end;
  }
}

void Engine::count_kept(Units rows) {
  if (rows.first == 0) {
    for (ModelTarget& target : targets_) target.kept = 0;
  }
  for (const FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (!row.held_out && row.weight > 0) targets_[row.target].kept += row.merged.count;
  }
}

// A target that would lose all of its rows keeps them.
void Engine::keep_targets(Units rows) {
  if (rows.first == 0) summary_.rejected = 0;
  for (FitRow& row : rows_.subspan(rows.first, rows.last - rows.first)) {
    if (targets_[row.target].kept == 0) row.weight = 1;
    summary_.rejected += row.merged.count * std::size_t{!row.held_out && row.weight == 0};
  }
}

}  // namespace armsig::calibration
