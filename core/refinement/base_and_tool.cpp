// SPDX-License-Identifier: MIT
#include "core/refinement/base_and_tool.hpp"

#include <cmath>

#include "core/numerics/robust.hpp"
#include "core/refinement/base_and_targets.hpp"
#include "core/refinement/rotation_search.hpp"
#include "core/refinement/row.hpp"

namespace armsig::refinement {

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

// Robust scale of the residual lengths of one target's rows, per axis.
double residual_scale(const DrawnRows& rows, std::size_t target, const Pose& X_SB,
                      const Vector3& u) {
  numerics::LogHistogram squares;
  rows.for_each_of(target, [&](const Observation& row, const Pose& X_BL) {
    squares.add((row.p_S - X_SB * (X_BL * u)).squaredNorm());
  });
  return numerics::robust_scale_m(squares);
}

// A further target, once the base is known: the mean of where its rows put it, robustly.
Vector3 place_target(const DrawnRows& rows, std::size_t target, const Pose& X_SB) {
  Vector3 u = Vector3::Zero();
  const Pose X_BS = X_SB.inverse();
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    const double scale = residual_scale(rows, target, X_SB, u);
    double weight = 0;
    Vector3 sum = Vector3::Zero();
    rows.for_each_of(target, [&](const Observation& row, const Pose& X_BL) {
      const Vector3 seen = X_BL.inverse() * (X_BS * row.p_S);
      const double w = pass == 0 ? 1 : numerics::huber_weight((seen - u).norm(), scale);
      weight += w;
      sum += w * seen;
    });
    if (weight > 0) u = sum / weight;
  }
  return u;
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

}  // namespace

FixedVector<Pose, kMaxFrames> drawn_frames(const Arm& arm, const JointVector& effective) {
  FixedVector<Pose, kMaxFrames> X_BL;
  X_BL.push_back({});
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& joint = arm.joints[i];
    const bool revolute = joint.type == JointType::kRevolute;
    const Matrix3 R_z = rotation_z(joint.theta_rad + (revolute ? effective[i] : 0));
    const Vector3 p(joint.a_m, 0, joint.d_m + (revolute ? 0 : effective[i]));
    X_BL.push_back(X_BL.back() * Pose{R_z * rotation_x(joint.alpha_rad), R_z * p});
  }
  return X_BL;
}

Judged<BaseAndTool> fit_base_and_tool(const Arm& arm, std::span<const Observation> log,
                                      std::span<const Target> targets) {
  ARMSIG_CHECK(targets.size() <= kMaxTargets);
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
  if (targets.empty()) {
    return std::unexpected(Refusal{Error::kTooFewPoints, 0, static_cast<double>(kFewestRows)});
  }
  std::size_t main = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    if (targets[t].link != arm.joints.size()) continue;
    if (targets[main].link != arm.joints.size() || rows_of[t] > rows_of[main]) main = t;
  }
  if (targets[main].link != arm.joints.size()) rows_of[main] = 0;
  if (rows_of[main] < kFewestRows) {
    return std::unexpected(Refusal{Error::kTooFewPoints, static_cast<double>(rows_of[main]),
                                   static_cast<double>(kFewestRows)});
  }

  const DrawnRows rows(arm, log, targets);
  BaseAndTool found;
  found.main = main;
  Candidate best;
  double scale = 0;
  for (int pass = 0; pass < kRobustPasses; ++pass) {
    Moments moments;
    rows.for_each_of(main, [&](const Observation& row, const Pose& X_BL) {
      const double residual = (row.p_S - found.X_SB * (X_BL * best.u)).norm();
      moments.add(row.p_S, link_vector(X_BL),
                  pass == 0 ? 1 : numerics::huber_weight(residual, scale));
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
    found.X_SB = {best.R, moments.mean_p - best.R * mean_y};
    scale = residual_scale(rows, main, found.X_SB, best.u);
  }
  BaseAndTargets at{found.X_SB, {}};
  for (std::size_t t = 0; t < targets.size(); ++t) {
    at.p_LT.push_back(t == main         ? best.u
                      : rows_of[t] == 0 ? Vector3::Zero()
                                        : place_target(rows, t, found.X_SB));
  }
  if (targets.size() > 1) at = from_all_targets(rows, targets, rows_of, at);
  found.X_SB = at.X_SB;
  found.p_LT = at.p_LT;
  if (targets.size() > 1) scale = residual_scale(rows, at);
  double weight = 0;
  double squares = 0;
  rows.for_each([&](const Observation& row, const Pose& X_BL) {
    const double residual = (row.p_S - found.X_SB * (X_BL * found.p_LT[row.target])).norm();
    if (numerics::huber_weight(residual, scale) < 0.5) return;
    weight += 1;
    squares += residual * residual;
  });
  found.rms_m = weight > 0 ? std::sqrt(squares / weight) : 0;
  if (!found.X_SB.p.allFinite() || !best.u.allFinite()) {
    return std::unexpected(Refusal{Error::kNotConverged, found.rms_m, 0});
  }
  return found;
}

}  // namespace armsig::refinement
