// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "core/features/rls.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/rls_covariance.hpp"
#include "host_tests/support/simulated_sweep.hpp"

namespace armsig::features {
namespace {

using Rls = SquareRootRls<3, 2>;

constexpr double kRegressors[5][3] = {
    {1, 0.5, -2}, {1, 1.5, 0.3}, {1, -0.7, 1.1}, {1, 2.2, 0.9}, {1, -1.4, -0.6}};
constexpr double kRightHandSides[5][2] = {{1, 2}, {0.5, -1}, {3, 0.2}, {-2, 0.7}, {0.1, 1.9}};

Rls five_rows() {
  Rls rls;
  for (int i = 0; i < 5; ++i)
    rls.update(Eigen::Map<const Vector3>(kRegressors[i]),
               Eigen::Map<const Eigen::Vector2d>(kRightHandSides[i]));
  return rls;
}

// Golden values: numpy.linalg.lstsq of the five rows above.
TEST(SquareRootRls, solves_the_least_squares_problem) {
  Eigen::Matrix<double, 3, 2> expected;
  expected << 0.846247875727651, 0.8349825845231506, -0.7552152504790217, -0.26555091377907303,
      0.1509578421077012, -0.6091466544009959;
  EXPECT_LT((five_rows().solve() - expected).norm(), 1e-14);
}

TEST(SquareRootRls, keeps_the_products_of_the_residuals) {
  const Eigen::Matrix2d expected{{8.051038038290338, -2.9620242733338022},
                                 {-2.9620242733338022, 2.7037134268602863}};
  EXPECT_LT((five_rows().residual_products() - expected).norm(), 1e-13);
}

TEST(SquareRootRls, states_the_variance_of_a_prediction) {
  EXPECT_NEAR(five_rows().prediction_variance({1, 0.2, 0.4}), 0.24607490642988378, 1e-14);
}

TEST(SquareRootRls, inverse_of_the_factor_is_its_inverse) {
  const Rls rls = five_rows();
  const auto inverse = rls.inverse_factor();
  ASSERT_TRUE(inverse);
  const Matrix3 product = rls.factor() * *inverse;
  EXPECT_TRUE(product.isIdentity(1e-14));
}

TEST(SquareRootRls, factor_of_a_singular_problem_has_no_inverse) {
  Rls rls;
  for (int i = 0; i < 10; ++i) rls.update({1, 2, 0.1 * i}, {1, 1});
  ASSERT_FALSE(rls.inverse_factor());
  EXPECT_EQ(test::failure_of(rls.inverse_factor()), Error::kSingular);
}

TEST(SquareRootRls, regressors_not_told_apart_get_no_coefficient) {
  SquareRootRls<2, 1> rls;
  for (int i = 1; i < 10; ++i) rls.update({0.3 * i, 0.6 * i}, Eigen::Matrix<double, 1, 1>(0.9 * i));
  EXPECT_EQ(rls.rank(), 1);
  EXPECT_NEAR(rls.solve()(0, 0), 3, 1e-14);
  EXPECT_EQ(rls.solve()(1, 0), 0);
}

TEST(SquareRootRls, cannot_predict_what_it_has_not_seen) {
  SquareRootRls<2, 1> rls;
  for (int i = 0; i < 10; ++i) rls.update({1, 0.5}, Eigen::Matrix<double, 1, 1>(1.0));
  EXPECT_TRUE(std::isinf(rls.prediction_variance({1, 0.6})));
  EXPECT_NEAR(rls.prediction_variance({1, 0.5}), 0.1, 1e-14);
}

TEST(SquareRootRls, rows_of_the_factor_stand_for_the_measurements) {
  const Rls rls = five_rows();
  Rls from_factor;
  for (int i = 0; i < 3; ++i)
    from_factor.update(rls.factor().row(i).transpose(),
                       rls.rotated_right_hand_sides().row(i).transpose());
  EXPECT_LT((from_factor.solve() - rls.solve()).norm(), 1e-14);
}

TEST(SquareRootRls, without_measurements_knows_nothing) {
  EXPECT_EQ(Rls().rank(), 0);
  EXPECT_EQ(Rls().solve().norm(), 0);
}

TEST(CovarianceRls, agrees_with_the_square_root_form) {
  CovarianceRls<3, 2> rls(1e8);
  for (int i = 0; i < 5; ++i)
    rls.update(Eigen::Map<const Vector3>(kRegressors[i]),
               Eigen::Map<const Eigen::Vector2d>(kRightHandSides[i]));
  EXPECT_LT((rls.coefficients() - five_rows().solve()).norm(), 1e-4);
  const auto root = five_rows().inverse_factor();
  ASSERT_TRUE(root);
  const Matrix3 covariance = *root * root->transpose();
  EXPECT_LT((rls.covariance() - covariance).norm(), 1e-4);
}

// A million noisy rows of a circle's regressors; the truth is recovered to the noise over the root
// of their number, as any digits lost on the way would spoil.
template <typename Scalar>
double error_after_a_million_updates(Scalar noise) {
  test::Random random(5);
  SquareRootRls<3, 3, Scalar> rls;
  const Eigen::Matrix<Scalar, 3, 3> truth{{Scalar(0.2), Scalar(-0.1), Scalar(0.4)},
                                          {Scalar(0.5), Scalar(0.3), Scalar(-0.2)},
                                          {Scalar(-0.3), Scalar(0.6), Scalar(0.1)}};
  for (int i = 0; i < 1'000'000; ++i) {
    const Vector3 x = motion_regressors(JointType::kRevolute, 2e-6 * i);
    const Vector3 e = random.normal_vector();
    const Eigen::Matrix<Scalar, 3, 1> regressors = x.cast<Scalar>();
    rls.update(regressors, truth.transpose() * regressors + noise * e.cast<Scalar>());
  }
  return static_cast<double>((rls.solve() - truth).norm());
}

TEST(SquareRootRls, keeps_its_digits_over_a_million_updates_in_double) {
  EXPECT_LT(error_after_a_million_updates<double>(0), 1e-12);
  EXPECT_LT(error_after_a_million_updates<double>(1e-3), 3e-5);
}

TEST(SquareRootRls, stays_at_noise_level_over_a_million_updates_in_float) {
  // All nine coefficients together; a single precision number has 6e-8, and the regressors of this
  // arc are nearly dependent.
  EXPECT_LT(error_after_a_million_updates<float>(1e-3F), 1e-2);
}

}  // namespace
}  // namespace armsig::features
