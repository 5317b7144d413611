// SPDX-License-Identifier: MIT
// A swept Puma whose truth is known, and a refinement of it.
#pragma once

#include <algorithm>
#include <expected>
#include <memory>
#include <vector>

#include "core/refinement/refinement.hpp"
#include "core/uncertainty/tool_covariance.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::refinement {

using test::Cell;
using test::Log;
using test::Random;

inline constexpr double kSigma = 0.2e-3;

struct Fit {
  std::unique_ptr<Refined> refined = std::make_unique<Refined>();
  std::vector<RowOutcome> outcomes;
  std::expected<void, Refusal> done;
};

inline Fit fit(const Signature& start, const Log& log, const RefinementConfig& config = {}) {
  Fit result;
  result.outcomes.resize(log.size());
  result.done = refine(start, log, config, result.outcomes, *result.refined);
  return result;
}

inline double largest_error(const Refined& refined, const Cell& cell) {
  Random random(99);
  double largest = 0;
  for (int k = 0; k < 50; ++k) {
    const JointVector q = random.configuration(cell.arm);
    largest =
        std::max(largest, (uncertainty::tool_position(refined, q, 0) - cell.point(q, 0)).norm());
  }
  return largest;
}

struct Case {
  Random random;
  Cell cell;
  Signature start;
  Log log;
};

inline Case swept_puma(std::uint64_t seed, double sigma_m = kSigma, int mixed = 0) {
  Random random(seed);
  const Cell cell = test::puma_cell(random);
  const JointVector configuration = test::puma_configuration();
  const Signature start =
      test::disturbed(test::signature_of(cell, configuration), 2e-3, 2e-3, random);
  Log log;
  test::add_sweeps(cell, configuration, kPi, 30, sigma_m, random, log);
  test::add_poses(cell, mixed, sigma_m, random, log);
  return {random, cell, start, log};
}

}  // namespace armsig::refinement
