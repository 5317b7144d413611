// SPDX-License-Identifier: MIT
// Which rows are blunders (section 9 of ALGORITHMS): by the residuals' own scale, never by a stated
// one; and never a pose at which every target deviates alike, for that is the arm.
#include <algorithm>
#include <cmath>

#include "core/calibration/engine.hpp"
#include "core/refinement/robust.hpp"

namespace armsig::calibration {

namespace {

// The median length of three normal coordinates, in sigma.
constexpr double kMedianLength = 1.538;
// Of the soft weight at the start, and of rejection: in robust sigma.
constexpr double kSoft = 4;
constexpr double kGate = 6;
constexpr std::size_t kMostTogether = 64;  // rows of a pose judged together

}  // namespace

double Engine::residual_scale() const {
  refinement::LogHistogram lengths;
  double count = 0;
  for (const FitRow& row : rows_) {
    if (row.held_out) continue;
    lengths.add(std::sqrt(whitened_squares(row)));
    count += 3;
  }
  const double freedom = std::max(count - effective_, 0.05 * count);
  return std::max(1e-9, lengths.median() / kMedianLength * std::sqrt(count / freedom));
}

void Engine::weigh_softly() {
  const double scale = residual_scale();
  for (FitRow& row : rows_) {
    const double share = std::sqrt(whitened_squares(row)) / (kSoft * scale);
    row.weight = 1 / ((1 + share * share) * (1 + share * share));
  }
}

// The rows of one pose, residuals judged about their median where most of them lie far out.
void Engine::judge_pose(std::span<FitRow> pose, double gate) {
  std::size_t far = 0;
  bool several = false;
  for (FitRow& row : pose) {
    row.weight = whitened_squares(row) <= gate * gate ? 1 : 0;
    if (row.weight == 0) ++far;
    several = several || row.target != pose.front().target;
  }
  if (!several || 2 * far <= pose.size() || pose.size() > kMostTogether) return;
  Vector3 median;
  std::array<double, kMostTogether> values{};
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < pose.size(); ++k) values[k] = pose[k].residual[c];
    const auto end = values.begin() + static_cast<std::ptrdiff_t>(pose.size());
    std::sort(values.begin(), end);
    median[c] = 0.5 * (values[(pose.size() - 1) / 2] + values[pose.size() / 2]);
  }
  for (FitRow& row : pose) row.weight = (row.residual - median).norm() <= gate ? 1 : 0;
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
