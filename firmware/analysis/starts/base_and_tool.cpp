// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/base_and_tool.hpp"

#include <cmath>
#include <limits>

#include "core/calibration/row.hpp"
#include "core/numerics/robust.hpp"
#include "firmware/analysis/starts/base_and_targets.hpp"
#include "firmware/analysis/starts/rotation_search.hpp"

namespace armsig::calibration {

namespace {

constexpr int kRobustPasses = 12;
constexpr std::size_t kFewestRows = 4;
// Mean square about the mean below which nothing moved: rounding, in metres or unit vectors.
constexpr double kAtRest = 1e-20;

Vector12 link_vector(const Pose& X_BL) {
  Vector12 g;
  g << X_BL.p, X_BL.R.col(0), X_BL.R.col(1), X_BL.R.col(2);
  return g;
}

// A further target, once the base is known: the mean of where its rows put it, robustly.
void place_target(const DrawnRows& rows, std::size_t target, BaseAndTargets& at) {
  const Pose X_BS = at.X_SB.inverse();
  Vector3& u = at.p_LT[target];
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    const double scale = residual_scale(rows, at);
    double weight = 0;
    Vector3 sum = Vector3::Zero();
    rows.for_each([&](const Observation& row, const Pose& X_BL) {
      const Vector3 seen = X_BL.inverse() * (X_BS * row.p_S);
      const double w = pass == 0 ? 1 : numerics::huber_weight((seen - u).norm(), scale);
      weight += w;
      sum += w * seen;
    });
    if (weight > 0) u = sum / weight;
  }
}

// The fit of all rows, from the main target's; where targets are on other links, whose sweeps the
// main one may know nothing of, from a search of its own too.
BaseAndTargets from_all_targets(const DrawnRows& rows, std::span<const Target> targets,
                                std::span<const std::size_t> rows_of, const BaseAndTargets& start) {
  BaseAndTargets at = start;
  polish_base_and_targets(rows, at);
  bool other_links = false;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    other_links = other_links || (rows_of[t] > 0 && targets[t].link != targets[0].link);
  }
  if (!other_links) return at;
  BaseAndTargets searched = search_base_and_targets(rows, targets.size());
  polish_base_and_targets(rows, searched);
  return residual_scale(rows, searched) < residual_scale(rows, at) ? searched : at;
}

// How many rows each target has.
Judged<std::array<std::size_t, kMaxTargets>> count_rows(const Arm& arm,
                                                        std::span<const Observation> log,
                                                        std::span<const Target> targets) {
  std::array<std::size_t, kMaxTargets> rows_of{};
  for (std::size_t k = 0; k < log.size(); ++k) {
    const Observation& row = log[k];
    if (row.use != RowUse::kFit || row.kind != ObservationKind::kPosition) continue;
    ARMSIG_CHECK(row.target < targets.size() && row.readings.size() == arm.joints.size());
    if (!is_finite(row)) {
      return std::unexpected(Refusal{Error::kNotFinite, static_cast<double>(k), 0});
    }
    ++rows_of[row.target];
  }
  return rows_of;
}

// The target on the last link that has most rows.
Judged<std::size_t> main_target(const Arm& arm, std::span<const Target> targets,
                                std::span<const std::size_t> rows_of) {
  std::optional<std::size_t> main;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (targets[t].link != arm.joints.size()) continue;
    if (!main || rows_of[t] > rows_of[*main]) main = t;
  }
  const std::size_t rows = main ? rows_of[*main] : 0;
  if (rows >= kFewestRows) return *main;
  return std::unexpected(
      Refusal{Error::kTooFewPoints, static_cast<double>(rows), static_cast<double>(kFewestRows)});
}

// Base and main target from the rows of that target.
Judged<void> fit_main(const DrawnRows& rows, std::size_t main, BaseAndTargets& at) {
  Candidate best;
  double scale = std::numeric_limits<double>::infinity();  // at first all weigh one
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    Moments moments;
    rows.for_each([&](const Observation& row, const Pose& X_BL) {
      moments.add(row.p_S, link_vector(X_BL),
                  numerics::huber_weight(at.residual(row, X_BL).norm(), scale));
    });
    if (moments.gg.trace() <= kAtRest * moments.weight)
      return std::unexpected(Refusal{Error::kJointDidNotMove, 0, 0});
    if (moments.pp <= kAtRest * moments.weight)
      return std::unexpected(Refusal{Error::kCoincidentPoints, 0, 0});
    // Outliers may have hidden the true basin from the first search.
    if (pass == 0 || pass == kRobustPasses / 2) {
      best = search(moments);
    } else {
      polish(moments, best);
    }
    const Vector3 mean_y = combined(moments.mean_g, best.u);
    at.X_SB = {best.R, moments.mean_p - best.R * mean_y};
    at.p_LT[main] = best.u;
    scale = residual_scale(rows, at);
  }
  return {};
}

// Of the rows that carry at least half weight.
double rms_of_good_rows(const DrawnRows& rows, const BaseAndTargets& at) {
  const double scale = residual_scale(rows, at);
  double count = 0;
  double squares = 0;
  rows.for_each([&](const Observation& row, const Pose& X_BL) {
    const double residual = at.residual(row, X_BL).norm();
    if (numerics::huber_weight(residual, scale) < 0.5) return;
    count += 1;
    squares += residual * residual;
  });
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

Judged<BaseAndTool> fit_base_and_tool(const Arm& arm, std::span<const Observation> log,
                                      std::span<const Target> targets, std::span<Pose> memory) {
  ARMSIG_CHECK(targets.size() <= kMaxTargets);
  ARMSIG_TRY(rows_of, count_rows(arm, log, targets));
  ARMSIG_TRY(main, main_target(arm, targets, rows_of));
  DrawnRows rows(arm, log, targets);
  if (!memory.empty()) rows.keep_poses(memory);
  BaseAndTargets at;
  at.p_LT.resize(targets.size(), Vector3::Zero());
  if (auto fitted = fit_main(rows.of(main), main, at); !fitted)
    return std::unexpected(fitted.error());
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (t != main && rows_of[t] > 0) place_target(rows.of(t), t, at);
  }
  if (targets.size() > 1) at = from_all_targets(rows, targets, rows_of, at);
  const double rms_m = rms_of_good_rows(rows, at);
  if (!at.X_SB.p.allFinite() || !at.p_LT[main].allFinite()) {
    return std::unexpected(Refusal{Error::kNotConverged, rms_m, 0});
  }
  return BaseAndTool{at.X_SB, at.p_LT, main, rms_m};
}

}  // namespace armsig::calibration
