// SPDX-License-Identifier: MIT
// Numbers by mpmath, forty digits, its incomplete gamma and beta functions inverted by a secant
// search.
#include <cmath>

#include <gtest/gtest.h>

#include "core/numerics/quantiles.hpp"

namespace armsig::numerics {
namespace {

struct Golden {
  double freedom, noise_freedom, false_alarm, quantile;
};

class ChiSquareQuantile : public testing::TestWithParam<Golden> {};

TEST_P(ChiSquareQuantile, is_that_of_an_independent_computation) {
  const Golden& golden = GetParam();
  const double found =
      chi_square_quantile(golden.freedom, golden.false_alarm, golden.noise_freedom);
  EXPECT_NEAR(found / golden.quantile, 1, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(
    KnownUnit, ChiSquareQuantile,
    testing::Values(Golden{1, 0, 1e-4, 15.1367052266}, Golden{2, 0, 0.05, 5.99146454711},
                    Golden{3, 0, 1e-3, 16.2662361962}, Golden{3, 0, 1e-4, 21.1075134662},
                    Golden{3, 0, 2.866515718791939e-07, 33.2398250634},
                    Golden{7, 0, 0.1, 12.0170366238}, Golden{10, 0, 1e-3, 29.5882984451},
                    Golden{30, 0, 1e-4, 67.6326302574}, Golden{100, 0, 1e-3, 149.449252779},
                    Golden{101, 0, 2.866515718791939e-07, 188.675701019},
                    Golden{1000, 0, 1e-4, 1174.93349658}, Golden{10000, 0, 1e-3, 10442.7305654},
                    Golden{1e6, 0, 1e-4, 1005268.0396}));

INSTANTIATE_TEST_SUITE_P(
    UnitFound, ChiSquareQuantile,
    testing::Values(Golden{3, 1, 1e-4, 162113892.494}, Golden{3, 2, 1e-4, 29997.4999861},
                    Golden{3, 3, 1e-4, 1978.02013374}, Golden{3, 5, 1e-4, 258.874885346},
                    Golden{3, 12, 1e-4, 53.6984757878}, Golden{3, 40, 1e-4, 27.3833341748},
                    Golden{3, 1000, 1e-4, 21.3211026335}, Golden{30, 10, 1e-3, 224.06393121},
                    Golden{300, 5, 1e-3, 7168.74042778}, Golden{250, 100, 1e-3, 430.99461905},
                    Golden{3000, 3000, 1e-3, 3358.4882982}, Golden{1, 30, 1e-4, 20.0920637344},
                    Golden{60, 7.5, 1e-3, 646.825329546}, Golden{20, 1e5, 1e-3, 45.3209357208}));

TEST(ChiSquareQuantiles, those_kept_in_a_table_are_the_same) {
  for (std::size_t freedom = 1; freedom <= kChiSquare9999.size(); ++freedom) {
    const double exact = kChiSquare9999[freedom - 1];
    EXPECT_NEAR(chi_square_quantile(static_cast<double>(freedom), kReadingRefused) / exact, 1, 1e-7)
        << freedom;
  }
}

// The tail of 2 degrees is e^(-x/2), and (1 + x/n)^(-n/2) in a unit found with n.
TEST(ChiSquareQuantiles, of_two_degrees_are_the_closed_form_over_the_whole_range) {
  for (double alarm = 0.1; alarm > 1e-12; alarm /= 7) {
    EXPECT_NEAR(chi_square_quantile(2, alarm) / (-2 * std::log(alarm)), 1, 1e-9) << alarm;
    for (double n = 1; n < 1e6; n *= 3) {
      const double exact = n * std::expm1(-2 / n * std::log(alarm));
      EXPECT_NEAR(chi_square_quantile(2, alarm, n) / exact, 1, 1e-7) << alarm << " " << n;
    }
  }
}

// Squares of a variable of Student's law with one degree: tan^2 of the angle that its tail leaves.
TEST(ChiSquareQuantiles, of_one_degree_by_one_are_the_closed_form) {
  for (const double alarm : {0.1, kCheckRefused, kReadingRefused}) {
    const double t = 1 / std::tan(std::acos(-1) / 2 * alarm);
    EXPECT_NEAR(chi_square_quantile(1, alarm, 1) / (t * t), 1, 1e-7) << alarm;
  }
}

TEST(ChiSquareQuantiles, rise_with_the_degrees_and_fall_to_that_of_a_known_unit) {
  double former = 0;
  for (double freedom = 1; freedom < 2e6; freedom *= 1.3) {
    const double known = chi_square_quantile(freedom, kCheckRefused);
    EXPECT_GT(known, former) << freedom;
    EXPECT_GT(known, freedom);
    former = known;
    double found = HUGE_VAL;
    for (double noise = 1; noise < 1e6; noise *= 4) {
      const double next = chi_square_quantile(freedom, kCheckRefused, noise);
      EXPECT_LT(next, found) << freedom << " " << noise;
      EXPECT_GT(next, known) << freedom << " " << noise;
      found = next;
    }
  }
}

TEST(ChiSquareQuantiles, of_no_degrees_is_nothing) { EXPECT_EQ(chi_square_quantile(0, 1e-3), 0); }

}  // namespace
}  // namespace armsig::numerics
