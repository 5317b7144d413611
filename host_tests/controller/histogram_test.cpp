// SPDX-License-Identifier: MIT
// How long something took, in bins that double.
#include "firmware/controller/histogram.hpp"

#include <gtest/gtest.h>

namespace armsig::controller {
namespace {

using std::chrono::microseconds;

TEST(Histogram, has_a_mean_of_nothing_that_is_zero) { EXPECT_EQ(Histogram().mean_us(), 0); }

TEST(Histogram, counts_each_time_in_its_bin_and_the_longest_in_the_last) {
  Histogram histogram;
  for (const auto time : {hal::Duration(-1), hal::Duration(999), hal::Duration(microseconds(1)),
                          hal::Duration(microseconds(3)), hal::Duration(microseconds(4)),
                          hal::Duration(std::chrono::seconds(10))}) {
    histogram.add(time);
  }
  EXPECT_EQ(histogram.total, 6U);
  EXPECT_EQ(histogram.counts[0], 2U);
  EXPECT_EQ(histogram.counts[1], 1U);
  EXPECT_EQ(histogram.counts[2], 1U);
  EXPECT_EQ(histogram.counts[3], 1U);
  EXPECT_EQ(histogram.counts[15], 1U);
  EXPECT_EQ(histogram.largest, std::chrono::seconds(10));
  EXPECT_NEAR(histogram.mean_us(), (10e6 + 1 + 3 + 4 + 0.999 - 0.001) / 6, 1e-6);
}

}  // namespace
}  // namespace armsig::controller
