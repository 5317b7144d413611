// SPDX-License-Identifier: MIT
#include "firmware/analysis/starts/start.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/links.hpp"
#include "core/numerics/rotations.hpp"

namespace armsig::calibration {

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
  return *std::ranges::min_element(log, {}, distance);
}

}  // namespace

std::expected<void, Refusal> like_its_drawing(const Signature& drawn, const Signature& found,
                                              const StartLimits& limits) {
  // The angle between neighbouring axes is the same whatever the base and the joints' zeros; that
  // between others tells an axis that has turned about.
  const auto angle = [](const Signature& s, std::size_t i, std::size_t j) {
    const Vector3 a = s.X_SL[i].R.col(2);
    const Vector3 b = s.X_SL[j].R.col(2);
    return numerics::angle_between(a, b);
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
  signature.types = types_of(arm.joints);
  for (const Pose& X_BL : dh_frames(arm.joints, signature.configuration)) {
    signature.X_SL.push_back(fitted.X_SB * X_BL);
  }
  for (std::size_t t = 0; t < targets.size(); ++t) {
    Target target = targets[t];
    target.p_S = signature.X_SL[target.link] * fitted.p_LT[t];
    signature.targets.push_back(target);
  }
  return signature;
}

}  // namespace armsig::calibration
