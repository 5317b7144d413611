// SPDX-License-Identifier: MIT
#include "firmware/host_tool/identification/missed_sweeps.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "firmware/analysis/uncertainty/tool_covariance.hpp"

namespace armsig::tool {
namespace {

constexpr std::size_t kFewestOfSweep = 8;
// Noise is known by a median, and has longer tails than that tells: so much of its variance is none
// of the arm's.
constexpr double kChance = 1.5;

struct JudgedSweep {
  std::vector<double> lengths_m;  // of what the estimate misses its rows by
  double predicted = 0;           // sum of the variances of these
  double noise = 0;               // sum of the squares that the sensor's noise makes of them
};

using JudgedSweeps = std::map<std::pair<std::size_t, int>, JudgedSweep>;  // by sweep and target

JudgedSweeps judged_sweeps(const Evidence& evidence, const calibration::Refined& estimate) {
  const auto& targets = estimate.signature.targets;
  const RowNoise noise(evidence);
  JudgedSweeps sweeps;
  for (const EvidenceRow& row : evidence.rows) {
    const auto* target = std::ranges::find(targets, row.target, &Target::number);
    if (row.sweep == 0 || target == targets.end()) continue;
    const auto t = static_cast<std::size_t>(target - targets.begin());
    JudgedSweep& sweep = sweeps[{row.sweep, row.target}];
    sweep.lengths_m.push_back((row.p_S - uncertainty::tool_position(estimate, row.q, t)).norm());
    sweep.predicted += uncertainty::tool_covariance(estimate, row.q, t).trace();
    sweep.noise += noise.mean_square(row);
  }
  std::erase_if(sweeps, [](const auto& of) { return of.second.lengths_m.size() < kFewestOfSweep; });
  return sweeps;
}

// Of the lengths of a sweep that are no blunders among them.
double mean_square(const std::vector<double>& lengths_m) {
  const double gate_m = blunder_gate_m(lengths_m);
  double squares = 0;
  double kept = 0;
  for (const double length_m : lengths_m) {
    if (length_m > gate_m) continue;
    squares += length_m * length_m;
    ++kept;
  }
  return squares / kept;
}

}  // namespace

std::optional<MissedSweeps> judge_missed_sweeps(const Evidence& evidence,
                                                const calibration::Refined& estimate) {
  const JudgedSweeps sweeps = judged_sweeps(evidence, estimate);
  if (sweeps.empty()) return std::nullopt;
  double missed = 0;
  double predicted = 0;
  for (const auto& [of, sweep] : sweeps) {
    const auto rows = static_cast<double>(sweep.lengths_m.size());
    missed += std::max(0.0, mean_square(sweep.lengths_m) - kChance * sweep.noise / rows);
    predicted += sweep.predicted / rows;
  }
  const auto count = static_cast<double>(sweeps.size());
  return MissedSweeps{.missed_m = std::sqrt(missed / count),
                      .predicted_m = std::sqrt(predicted / count)};
}

}  // namespace armsig::tool
