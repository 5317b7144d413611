// SPDX-License-Identifier: MIT
// Raw ranges, and what else than axes and targets is found.
#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

// Four receivers around the arm; poses heard by fewer than three count too.
const Receivers kReceivers{Vector3(2, 0, 0), Vector3(-2, 0.5, 0), Vector3(0, 2.5, 0.2),
                           Vector3(0.3, 0, 3)};

Log ranges_of(const Cell& cell, int poses, double sigma_m, Random& random) {
  Log log;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const std::size_t heard = k % 3 == 0 ? 4 : static_cast<std::size_t>(k % 3);
    for (std::size_t r = 0; r < heard; ++r) {
      Observation row;
      row.kind = ObservationKind::kRange;
      row.receiver = (static_cast<std::size_t>(k) + r) % 4;
      row.readings = q;
      row.range_m = (cell.point(q, 0) - kReceivers[row.receiver]).norm() + random.normal(sigma_m);
      row.sigma_m = kSigma;
      log.push_back(row);
    }
  }
  return log;
}

TEST(Refine, takes_raw_ranges_of_poses_that_one_or_two_receivers_heard) {
  Case s = swept_puma(8);
  RefinementConfig config;
  config.receivers = kReceivers;
  const Fit result = fit(s.start, ranges_of(s.cell, 120, 0, s.random), config);
  ASSERT_TRUE(result.done);
  EXPECT_LT(largest_error(*result.refined, s.cell), 1e-7);
}

TEST(Refine, finds_a_range_offset_per_receiver) {
  Case s = swept_puma(9);
  Log log = ranges_of(s.cell, 150, 0, s.random);
  for (Observation& row : log) row.range_m += 1e-3 * static_cast<double>(row.receiver);
  RefinementConfig config;
  config.receivers = kReceivers;
  config.request.receiver_offsets = true;
  const Fit result = fit(s.start, log, config);
  ASSERT_TRUE(result.done);
  for (std::size_t r = 0; r < 4; ++r) {
    EXPECT_NEAR(result.refined->receiver_offsets_m[r], 1e-3 * static_cast<double>(r), 1e-6);
  }
}

TEST(Refine, refuses_a_scale_from_angles_alone) {
  Case s = swept_puma(10, kSigma, 20);
  RefinementConfig config;
  config.request.scale = true;
  const Fit result = fit(s.start, s.log, config);
  ASSERT_FALSE(result.done);
  EXPECT_EQ(test::failure_of(result.done).error, Error::kScaleUndetermined);
}

TEST(Refine, finds_the_scale_by_a_prismatic_joint) {
  Random random(11);
  Cell cell = test::puma_cell(random);
  cell.arm.joints[2] = {JointType::kPrismatic, -kPi / 2, 0.3, 0.02, 0};
  cell.arm.limits[2] = {0.1, 0.7};
  JointVector configuration = test::puma_configuration();
  configuration[2] = 0.3;
  Log log;
  test::add_poses(cell, 60, 0, random, log);
  for (Observation& row : log) row.p_S *= 1.004;
  RefinementConfig config;
  config.request.scale = true;
  const Fit result = fit(
      test::disturbed(test::signature_of(cell, configuration), 2e-3, 2e-3, random), log, config);
  ASSERT_TRUE(result.done);
  EXPECT_NEAR(result.refined->scale, 0.004, 1e-7);
}

TEST(Refine, keeps_a_scale_asked_for_with_a_prior_of_its_own) {
  Case s = swept_puma(12, kSigma, 20);
  RefinementConfig config;
  config.request.scale = true;
  config.prior.scale = 1e-4;
  EXPECT_TRUE(fit(s.start, s.log, config).done);
}

}  // namespace
}  // namespace armsig::refinement
