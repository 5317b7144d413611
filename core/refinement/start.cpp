// SPDX-License-Identifier: MIT
#include "core/refinement/start.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::refinement {

namespace {

// The row whose readings are nearest to the mean of all, each joint measured by its own spread.
const Observation& middle_row(std::span<const Observation> log) {
  const std::size_t n = log.front().readings.size();
  JointVector mean(n, 0.0);
  JointVector spread(n, 0.0);
  const auto rows = static_cast<double>(log.size());
  for (const Observation& row : log) {
    for (std::size_t i = 0; i < n; ++i) mean[i] += row.readings[i] / rows;
  }
  for (const Observation& row : log) {
    for (std::size_t i = 0; i < n; ++i) spread[i] += std::pow(row.readings[i] - mean[i], 2) / rows;
  }
  const auto distance = [&](const Observation& row) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (spread[i] > 0) sum += std::pow(row.readings[i] - mean[i], 2) / spread[i];
    }
    return sum;
  };
  const Observation* nearest = &log.front();
  double least = distance(*nearest);
  for (const Observation& row : log) {
    if (const double d = distance(row); d < least) {
      least = d;
      nearest = &row;
    }
  }
  return *nearest;
}

// Refuses what no arm made to its drawing would give.
std::expected<void, Refusal> believe(const Signature& start, const Refined& refined,
                                     const StartLimits& limits) {
  const auto refuse = [](double found, double allowed) {
    return std::unexpected(Refusal{Error::kNotConverged, found, allowed});
  };
  if (!(refined.quality.rms_m <= limits.rms_m)) return refuse(refined.quality.rms_m, limits.rms_m);
  for (std::size_t i = 0; i < start.joint_count(); ++i) {
    const Pose& X_drawn = start.X_SL[i];
    const Pose& X_found = refined.signature.X_SL[i];
    const double turned = std::atan2(X_drawn.R.col(2).cross(X_found.R.col(2)).norm(),
                                     X_drawn.R.col(2).dot(X_found.R.col(2)));
    if (!(turned <= limits.direction_rad)) return refuse(turned, limits.direction_rad);
    const double shifted = (X_found.p - X_drawn.p).norm();
    if (!(shifted <= limits.position_m)) return refuse(shifted, limits.position_m);
  }
  return {};
}

}  // namespace

Signature drawn_signature(const Arm& arm, const BaseAndTool& fitted,
                          std::span<const Observation> log, std::span<const Target> targets) {
  ARMSIG_CHECK(!log.empty());
  Signature signature;
  signature.configuration = middle_row(log).readings;
  const JointVector coupled =
      coupled_readings({arm.couplings, {}}, signature.configuration);
  for (const DhJoint& joint : arm.joints) signature.types.push_back(joint.type);
  for (const Pose& X_BL : drawn_frames(arm, coupled)) {
    signature.X_SL.push_back(fitted.X_SB * X_BL);
  }
  for (std::size_t t = 0; t < targets.size(); ++t) {
    Target target = targets[t];
    target.p_S = signature.X_SL[target.link] * fitted.p_LT[t];
    signature.targets.push_back(target);
  }
  return signature;
}

std::expected<void, Refusal> refine_from_drawing(const Arm& arm, std::span<const Observation> log,
                                                 std::span<const Target> targets,
                                                 const RefinementConfig& config,
                                                 std::span<RowOutcome> outcomes, Refined& refined,
                                                 const StartLimits& limits, BaseAndTool* drawn) {
  ARMSIG_TRY(fitted, fit_base_and_tool(arm, log, targets));
  if (drawn != nullptr) *drawn = fitted;
  const Signature start = drawn_signature(arm, fitted, log, targets);
  RefinementConfig coupled = config;
  coupled.readings.couplings = arm.couplings;
  const std::expected<void, Refusal> done = refine(start, log, coupled, outcomes, refined);
  if (!done) return done;
  return believe(start, refined, limits);
}

}  // namespace armsig::refinement
