// SPDX-License-Identifier: MIT
// The refinement of a signature over everything measured, by armsig.
#include <cstdlib>
#include <memory>

#include "host_tests/benchmarks/refinement_work.hpp"
#include "host_tests/benchmarks/rows.hpp"

namespace armsig::benchmarks {

// Noise is kept inside the knee of the robust weights, so that least squares has the same answer.
RefinementWork refinement_work(const RefinementLog& of) {
  test::Random random(13);
  RefinementWork work;
  work.cell = test::puma_cell(random);
  const JointVector held = test::puma_configuration();
  work.start = test::disturbed(test::signature_of(work.cell, held), 2e-3, 2e-3, random);
  if (of.points_per_sweep > 0) {
    test::add_sweeps(work.cell, held, kPi, of.points_per_sweep, 0, random, work.log);
  }
  test::add_poses(work.cell, of.mixed_rows, 0, random, work.log);
  for (auto& row : work.log) {
    Vector3 noise = random.normal_vector(kRefinementSigma_m);
    const double most = 3 * kRefinementSigma_m;
    if (noise.norm() > most) noise *= most / noise.norm();
    row.p_S += noise;
    row.sigma_m = kRefinementSigma_m;
  }
  return work;
}

void refine(const RefinementWork& work, refinement::Refined& refined) {
  static std::vector<refinement::RowOutcome> outcomes;
  outcomes.resize(work.log.size());
  if (!refinement::refine(work.start, work.log, {}, outcomes, refined)) std::abort();
}

namespace {

struct RefinementRows {
  RefinementRows() {
    for (const RefinementLog& of : kRefinementLogs) {
      const Row row(
          of.path, "armsig",
          [of] {
            return [work = refinement_work(of),
                    refined = std::make_shared<refinement::Refined>()](std::size_t calls) {
              for (std::size_t k = 0; k < calls; ++k) {
                refine(work, *refined);
                keep(*refined);
              }
            };
          },
          1);
    }
  }
};
const RefinementRows kRefinementRows;

}  // namespace
}  // namespace armsig::benchmarks
