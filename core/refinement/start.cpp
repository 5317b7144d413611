// SPDX-License-Identifier: MIT
#include "core/refinement/start.hpp"

#include <algorithm>
#include <cmath>

#include "core/refinement/zero_offsets.hpp"

namespace armsig::refinement {

namespace {

// Residual lengths of three coordinates are 1.7 sigma; so many sigma are more than outliers let
// through.
constexpr double kCoarse = 4;

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
  // A sensor stated to be coarse may leave more; one whose sigma was found from the fit may not.
  const FitQuality& quality = refined.quality;
  const double stated = quality.sigma_is_estimated ? 0 : kCoarse * quality.sigma_m;
  const double allowed_m = std::max(limits.rms_m, stated);
  if (!(quality.rms_m <= allowed_m)) return refuse(quality.rms_m, allowed_m);
  return like_its_drawing(start, refined.signature, limits);
}

}  // namespace

std::expected<void, Refusal> like_its_drawing(const Signature& drawn, const Signature& found,
                                              const StartLimits& limits) {
  // The angle between neighbouring axes is the same whatever the base and the joints' zeros; that
  // between others tells an axis that has turned about.
  const auto angle = [](const Signature& s, std::size_t i, std::size_t j) {
    const Vector3 a = s.X_SL[i].R.col(2);
    const Vector3 b = s.X_SL[j].R.col(2);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  for (std::size_t i = 0; i < drawn.joint_count(); ++i) {
    for (std::size_t j = i + 1; j < drawn.joint_count(); ++j) {
      const double allowed = j == i + 1 ? limits.twist_rad : limits.turned_rad;
      const double change = std::abs(angle(found, i, j) - angle(drawn, i, j));
      if (!(change <= allowed)) {
        return std::unexpected(Refusal{Error::kNotConverged, change, allowed});
      }
    }
  }
  return {};
}

Signature drawn_signature(const Arm& arm, const BaseAndTool& fitted,
                          std::span<const Observation> log, std::span<const Target> targets) {
  ARMSIG_CHECK(!log.empty());
  Signature signature;
  signature.configuration = effective_readings(arm, middle_row(log).readings);
  for (const DhJoint& joint : arm.joints) signature.types.push_back(joint.type);
  for (const Pose& X_BL : drawn_frames(arm, signature.configuration)) {
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
                                                 const StartLimits& limits, DrawingReport* report,
                                                 std::span<const Observation> positions) {
  if (positions.empty()) positions = log;
  RefinementConfig coupled = config;
  coupled.readings.couplings = arm.couplings;
  const auto refine_near = [&](const Arm& near,
                               const BaseAndTool& fitted) -> std::expected<void, Refusal> {
    if (!(fitted.rms_m <= limits.drawn_rms_m)) {
      return std::unexpected(Refusal{Error::kNotConverged, fitted.rms_m, limits.drawn_rms_m});
    }
    const Signature start = drawn_signature(near, fitted, log, targets);
    const std::expected<void, Refusal> done = refine(start, log, coupled, outcomes, refined);
    if (!done) return done;
    return believe(start, refined, limits);
  };
  ARMSIG_TRY(fitted, fit_base_and_tool(arm, positions, targets));
  if (report != nullptr) *report = {fitted.rms_m, {}};
  const std::expected<void, Refusal> done = refine_near(arm, fitted);
  if (done || (done.error().error != Error::kNotConverged &&
               done.error().error != Error::kTooManyOutliers)) {
    return done;
  }
  const auto zeroed = fit_zeros(arm, positions, targets);
  if (!zeroed || !refine_near(zeroed->arm, zeroed->fitted)) return done;
  if (report != nullptr) report->zero_shifts = zeroed->shifts;
  return {};
}

}  // namespace armsig::refinement
