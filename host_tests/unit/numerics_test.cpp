// SPDX-License-Identifier: MIT
// Numbers from the published tables.
#include <gtest/gtest.h>

#include "core/numerics/quantiles.hpp"

namespace armsig::numerics {
namespace {

TEST(ChiSquareQuantile, agrees_with_the_tables) {
  // 99.9 % points of the chi-square law: 16.266 (3), 29.588 (10), 149.449 (100).
  EXPECT_NEAR(chi_square_quantile(3, 3.0902), 16.266, 0.3);
  EXPECT_NEAR(chi_square_quantile(10, 3.0902), 29.588, 0.2);
  EXPECT_NEAR(chi_square_quantile(100, 3.0902), 149.449, 0.1);
  // Tables of the F distribution at 0.999.
  EXPECT_NEAR(chi_square_quantile(30, 3.0902, 30), 30 * 3.217, 1);
  EXPECT_NEAR(chi_square_quantile(10, 3.0902, 30), 10 * 4.239, 1);
  EXPECT_GT(chi_square_quantile(10, 3.0902, 1), 1e6);
}

TEST(ChiSquareQuantile, agrees_with_the_exact_ones_that_are_kept) {
  for (std::size_t freedom = 3; freedom <= kChiSquare9999.size(); ++freedom) {
    const double exact = kChiSquare9999[freedom - 1];
    EXPECT_NEAR(chi_square_quantile(static_cast<double>(freedom), kNormal9999) / exact, 1, 0.04)
        << freedom;
  }
}

}  // namespace
}  // namespace armsig::numerics
