// SPDX-License-Identifier: MIT
#include "core/refinement/compressed_sweep.hpp"

#include <gtest/gtest.h>

#include "core/refinement/robust.hpp"
#include "host_tests/support/refinement_case.hpp"

namespace armsig::refinement {
namespace {

TEST(CompressSweep, refuses_rows_that_do_not_determine_a_circle) {
  Case s = swept_puma(25);
  std::vector<RowOutcome> outcomes(s.log.size());
  const Chain chain(s.start, {});
  CompressedSweep sweep;
  EXPECT_EQ(sweep_length(s.log, 0, {}), 30U);
  EXPECT_TRUE(compress_sweep(s.log, 0, 30, chain, JointType::kRevolute, outcomes, sweep));
  EXPECT_FALSE(compress_sweep(s.log, 0, 3, chain, JointType::kRevolute, outcomes, sweep));
  for (std::size_t k = 0; k < 30; ++k) s.log[k].readings = s.log[0].readings;
  EXPECT_FALSE(compress_sweep(s.log, 0, 30, chain, JointType::kRevolute, outcomes, sweep));
}

TEST(CompressSweep, leaves_alone_a_sweep_that_carries_another_joint_along) {
  Case s = swept_puma(26);
  ReadingModel readings;
  readings.couplings.push_back({1, 0, 1.0});
  EXPECT_EQ(sweep_length(s.log, 0, readings), 0U);
  EXPECT_EQ(sweep_length(s.log, 30, readings), 30U);
}

TEST(LogHistogram, median_is_within_a_few_per_cent_of_the_sorted_one) {
  Random random(27);
  LogHistogram histogram;
  std::vector<double> values;
  for (int k = 0; k < 1001; ++k) {
    const double v = std::pow(random.normal(1e-3), 2);
    histogram.add(v);
    values.push_back(v);
  }
  std::nth_element(values.begin(), values.begin() + 500, values.end());
  EXPECT_NEAR(histogram.median() / values[500], 1, 0.03);
  EXPECT_EQ(LogHistogram{}.median(), 0);
}

}  // namespace
}  // namespace armsig::refinement
