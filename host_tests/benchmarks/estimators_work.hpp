// SPDX-License-Identifier: MIT
// The work of the estimators' rows: one function of the angle sampled with noise; a sweep of a
// joint whose target is half a metre off its axis, over 90 degrees, with the 0.1 mm of noise that
// it states.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "core/features/sweep_estimator.hpp"

namespace armsig::benchmarks {

inline constexpr std::size_t kRlsRows = 256;  // a power of two
inline constexpr const char* kRlsPath = "RLS update, three regressors";

struct RlsWork {
  std::array<Vector3, kRlsRows> regressors;
  std::array<double, kRlsRows> measured;
};
const RlsWork& rls_work();

// As long as the controller makes them, and ten times that.
inline constexpr std::array<std::size_t, 2> kSweepPoints = {36, 360};
inline std::string sweep_path(std::size_t points) {
  return "sweep of " + std::to_string(points) + " points to its feature";
}

inline constexpr double kSweepSigma_m = 1e-4;

std::vector<features::SweepPoint> sweep_of(std::size_t points);

// Each point gated as it comes, then the fit and its covariance: what a sweep of the controller is.
features::JointFeature feature_of(const std::vector<features::SweepPoint>& sweep);

}  // namespace armsig::benchmarks
