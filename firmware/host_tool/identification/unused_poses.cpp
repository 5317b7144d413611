// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/unused_poses.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "firmware/analysis/uncertainty/tool_covariance.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewest = 12;
// Of the median's sigma per axis: deflection by gravity is skew, and beyond it are blunders.
constexpr double kClipSigmas = 5;

}  // namespace

std::optional<UnusedPoses> judge_unused_poses(const Evidence& evidence,
                                              const calibration::Refined& estimate) {
  const RowNoise row_noise(evidence);
  const auto& targets = estimate.signature.targets;
  std::vector<double> lengths_m;
  double predicted = 0;
  double noise = 0;
  for (const EvidenceRow& row : evidence.rows) {
    const auto* target = std::ranges::find(targets, row.target, &Target::number);
    if (row.sweep != 0 || target == targets.end()) continue;
    const auto t = static_cast<std::size_t>(target - targets.begin());
    lengths_m.push_back((row.p_S - uncertainty::tool_position(estimate, row.q, t)).norm());
    predicted += uncertainty::tool_covariance(estimate, row.q, t).trace();
    noise += row_noise.mean_square(row);
  }
  if (lengths_m.size() < kFewest) return std::nullopt;
  UnusedPoses found{.count = lengths_m.size()};
  predicted /= static_cast<double>(found.count);
  found.predicted_m = std::sqrt(predicted);
  const double most_m = kClipSigmas * sigma_by_median(lengths_m);
  double squares = 0;
  for (const double length : lengths_m) squares += std::pow(std::min(length, most_m), 2);
  found.missed_m = std::sqrt(std::max(0.0, squares - noise) / static_cast<double>(found.count));
  return found;
}

}  // namespace armsig::tool
