// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/numerics/robust.hpp"

namespace armsig::numerics {
namespace {

TEST(LogHistogram, has_the_median_of_what_was_added) {
  LogHistogram histogram;
  for (int k = 0; k <= 1000; ++k) histogram.add(std::exp(0.01 * (k - 500)));
  EXPECT_NEAR(histogram.median(), 1, 0.02);
}

TEST(LogHistogram, counts_a_value_as_often_as_it_is_said_to_occur) {
  LogHistogram histogram;
  histogram.add(1, 10);
  histogram.add(100, 90);
  EXPECT_NEAR(histogram.median(), 100, 10);
}

TEST(LogHistogram, of_nothing_has_the_median_zero) { EXPECT_EQ(LogHistogram{}.median(), 0); }

TEST(RobustScale, is_one_sigma_per_axis_whatever_four_in_ten_blunders_say) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal(0, 2e-4);
  LogHistogram sound;
  LogHistogram mixed;
  for (int k = 0; k < 20000; ++k) {
    const double x = normal(generator);
    const double y = normal(generator);
    const double z = normal(generator);
    sound.add(x * x + y * y + z * z);
    mixed.add(k % 10 < 4 ? 1 : x * x + y * y + z * z);
  }
  EXPECT_NEAR(robust_scale_m(sound), 2e-4, 0.02 * 2e-4);
  EXPECT_LT(robust_scale_m(mixed), 2 * 2e-4);
}

TEST(RobustScale, of_exact_data_is_the_least) {
  LogHistogram exact;
  exact.add(0, 100);
  EXPECT_EQ(robust_scale_m(exact), kLeastScale_m);
}

// The weight is the loss's slope over that of the squares.
TEST(Huber, weight_descends_the_loss) {
  const double scale = 0.3;
  const double step = 1e-6;
  for (const double residual : {0.1, 0.59, 0.61, 2.0, 50.0}) {
    const double slope =
        (huber_loss(residual + step, scale) - huber_loss(residual - step, scale)) / (2 * step);
    EXPECT_NEAR(huber_weight(residual, scale), slope / (2 * residual), 1e-6) << residual;
  }
}

TEST(Huber, loss_has_no_step_at_the_knee) {
  EXPECT_NEAR(huber_loss(0.6, 0.3), huber_loss(std::nextafter(0.6, 1), 0.3), 1e-14);
  EXPECT_DOUBLE_EQ(huber_loss(0.5, 0.3), 0.25);
}

}  // namespace
}  // namespace armsig::numerics
