// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/measurement/ping_median.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::measurement {
namespace {

Range heard(double metres) { return {.metres = metres, .valid = true}; }
const Range kSilence{};

TEST(PingMedian, odd_count_is_the_middle_one) {
  PingMedian dwell(1);
  for (const double metres : {1.3, 1.1, 1.2}) ASSERT_TRUE(dwell.add({heard(metres)}));
  EXPECT_EQ(dwell.median()[0].metres, 1.2);
}

TEST(PingMedian, even_count_is_the_mean_of_the_middle_two) {
  PingMedian dwell(1);
  for (const double metres : {1.5, 1.0, 1.25, 9.0}) ASSERT_TRUE(dwell.add({heard(metres)}));
  EXPECT_EQ(dwell.median()[0].metres, 1.375);
}

TEST(PingMedian, is_taken_per_receiver) {
  PingMedian dwell(2);
  ASSERT_TRUE(dwell.add({heard(1.0), heard(2.5)}));
  ASSERT_TRUE(dwell.add({heard(1.1), heard(2.3)}));
  ASSERT_TRUE(dwell.add({heard(1.2), heard(2.4)}));
  EXPECT_EQ(dwell.median()[0].metres, 1.1);
  EXPECT_EQ(dwell.median()[1].metres, 2.4);
}

TEST(PingMedian, one_detour_in_five_moves_it_by_noise_only) {
  PingMedian dwell(1);
  for (const double metres : {1.0001, 1.2, 0.9999, 1.0002, 1.0})
    ASSERT_TRUE(dwell.add({heard(metres)}));
  EXPECT_EQ(dwell.median()[0].metres, 1.0001);
}

TEST(PingMedian, counts_what_each_receiver_heard) {
  PingMedian dwell(2);
  ASSERT_TRUE(dwell.add({heard(1), kSilence}));
  ASSERT_TRUE(dwell.add({heard(1), heard(2)}));
  EXPECT_EQ(dwell.pings(), 2U);
  EXPECT_EQ(dwell.heard(0), 2U);
  EXPECT_EQ(dwell.heard(1), 1U);
}

TEST(PingMedian, a_receiver_that_heard_less_than_half_is_not_believed) {
  PingMedian dwell(3);
  ASSERT_TRUE(dwell.add({heard(1), heard(2), kSilence}));
  ASSERT_TRUE(dwell.add({kSilence, heard(2), kSilence}));
  ASSERT_TRUE(dwell.add({kSilence, kSilence, kSilence}));
  const Ranges ranges = dwell.median();
  EXPECT_FALSE(ranges[0].valid);
  EXPECT_TRUE(ranges[1].valid);
  EXPECT_FALSE(ranges[2].valid);
}

TEST(PingMedian, nothing_measured_is_nothing_valid) {
  EXPECT_FALSE(PingMedian(1).median()[0].valid);
}

TEST(PingMedian, states_the_sigma_of_as_many_pings_as_were_heard) {
  PingMedian dwell(2);
  ASSERT_TRUE(dwell.add({heard(1), heard(2)}));
  ASSERT_TRUE(dwell.add({heard(1), heard(2)}));
  ASSERT_TRUE(dwell.add({heard(1), kSilence}));
  EXPECT_EQ(dwell.median()[0].sigma_factor, median_sigma(3));
  EXPECT_EQ(dwell.median()[1].sigma_factor, median_sigma(2));
}

TEST(PingMedian, refuses_more_pings_than_it_holds) {
  PingMedian dwell(1);
  for (std::size_t i = 0; i < kMaxPings; ++i) ASSERT_TRUE(dwell.add({heard(1)}));
  EXPECT_EQ(test::failure_of(dwell.add({heard(2)})), Error::kCapacityExceeded);
  EXPECT_EQ(dwell.pings(), kMaxPings);
}

TEST(PingMedian, refuses_a_range_that_is_not_a_number_whole) {
  PingMedian dwell(2);
  EXPECT_EQ(test::failure_of(dwell.add({heard(1), heard(std::numeric_limits<double>::infinity())})),
            Error::kNotFinite);
  EXPECT_EQ(dwell.pings(), 0U);
  EXPECT_EQ(dwell.heard(0), 0U);
}

// Golden values: by numerical integration over the mean and the distance of the middle two (of an
// odd count over the middle one), to 2e-5; those of 3 and 5 are as tabulated for order statistics
// (variances 0.448671, 0.286834).
TEST(MedianSigma, is_that_of_the_order_statistics_for_every_count) {
  constexpr std::array<double, kMaxPings> kSigma = {
      1.00000, 0.70711, 0.66983, 0.54608, 0.53557, 0.46340, 0.45874, 0.41010,
      0.40756, 0.37193, 0.37035, 0.34281, 0.34176, 0.31965, 0.31890, 0.30065};
  for (std::size_t count = 1; count <= kMaxPings; ++count) {
    EXPECT_NEAR(median_sigma(count), kSigma[count - 1], 3e-5) << count << " pings";
  }
}

TEST(MedianSigma, is_what_medians_of_random_pings_scatter_by) {
  constexpr int kTrials = 20'000;  // the scatter of the estimate is 0.5 %
  simulated::Random random(3);
  for (const std::size_t count : {4U, 8U, 9U, 15U, 16U}) {
    double sum = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      PingMedian dwell(1);
      for (std::size_t i = 0; i < count; ++i) ASSERT_TRUE(dwell.add({heard(random.normal())}));
      sum += std::pow(dwell.median()[0].metres, 2);
    }
    EXPECT_NEAR(std::sqrt(sum / kTrials) / median_sigma(count), 1, 0.02) << count << " pings";
  }
}

}  // namespace
}  // namespace armsig::measurement
