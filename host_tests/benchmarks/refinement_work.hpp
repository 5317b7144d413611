// SPDX-License-Identifier: MIT
// The work of the refinement rows: a Puma of 27 unknowns, its start two milliradians and
// millimetres off everywhere, positions measured to 0.2 mm.
#pragma once

#include <array>
#include <string>

#include "core/refinement/refinement.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::benchmarks {

inline constexpr double kRefinementSigma_m = 2e-4;

struct RefinementLog {
  std::string path;
  int points_per_sweep;  // of each of six sweeps; 0: none
  int mixed_rows;
};
inline const std::array<RefinementLog, 3> kRefinementLogs = {
    {{"refinement, 27 parameters, 6 x 36 points", 36, 0},
     {"refinement, 6 joints, 216 swept and 34 mixed rows", 36, 34},
     {"refinement, 6 joints, 250 mixed rows", 0, 250}}};

struct RefinementWork {
  Signature start;
  test::Log log;
  test::Cell cell;
};
RefinementWork refinement_work(const RefinementLog& of);

// Aborts where it is refused.
void refine(const RefinementWork& work, refinement::Refined& refined);

}  // namespace armsig::benchmarks
