// SPDX-License-Identifier: MIT
// More targets than joints: what is told of a target is not looked up among the joints.
#include <algorithm>

#include <gtest/gtest.h>

#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

TEST(Refine, names_the_tenth_target_where_it_is_not_determined) {
  Random random(15);
  Cell cell = test::puma_cell(random);
  while (cell.p_tool.size() < 10) cell.p_tool.push_back(0.1 * random.direction());
  const Signature start =
      test::disturbed(test::signature_of(cell, test::puma_configuration()), 1e-4, 1e-4, random);
  Log log;
  test::add_poses(cell, 60, kSigma, random, log);
  for (std::size_t target = 1; target < 10; ++target) {
    for (int k = 0; k < 6; ++k) {
      log.push_back(test::observe(cell, random.configuration(cell.arm), target, kSigma, random));
      // The last one is seen by a sensor as good as none.
      if (target == 9) log.back().sigma_m = 10;
    }
  }
  const Fit result = fit(start, log);
  ASSERT_TRUE(result.done);
  const auto& open = result.refined->undetermined;
  EXPECT_TRUE(std::any_of(open.begin(), open.end(), [](const Undetermined& found) {
    return found.open == Open::kTarget && found.index == 9;
  }));
}

}  // namespace
}  // namespace armsig::refinement
