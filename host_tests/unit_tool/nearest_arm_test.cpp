// SPDX-License-Identifier: MIT
// What the nearest arm is found by: where its base is, and the normal equations of its deviations.
#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "core/numerics/rotations.hpp"
#include "firmware/host_tool/diagnosis/base_search.hpp"
#include "firmware/host_tool/diagnosis/deviating_chain.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::tool {
namespace {

const Pose kBase{rotation_z(0.7) * rotation_x(-2.1), {1.2, -0.4, 0.9}};

TEST(BaseSearch, finds_base_and_targets_of_an_exact_arm) {
  const Arm arm = test::puma();
  test::Random random(41);
  const std::vector<Vector3> p_LT{{0.1, -0.02, 0.2}, {-0.05, 0.12, 0.03}};
  constexpr std::array<std::size_t, 2> kLinks{6, 3};
  std::vector<PlacedRow> rows;
  for (std::size_t k = 0; k < 40; ++k) {
    const std::size_t target = k % 2;
    const Pose X_BL = dh_frames(arm.joints, random.configuration(arm))[kLinks[target]];
    rows.push_back({X_BL, kBase * (X_BL * p_LT[target]), target});
  }
  rows.front().p_S += Vector3(0, 0.3, 0);
  const std::vector<BasePlace> places = find_base(rows, p_LT.size());
  ASSERT_FALSE(places.empty());
  EXPECT_LT((places[0].X_SB.p - kBase.p).norm(), 1e-6);
  EXPECT_LT(angle_between(places[0].X_SB.R, kBase.R), 1e-6);
  for (std::size_t t = 0; t < p_LT.size(); ++t) {
    EXPECT_LT((places[0].p_LT[t] - p_LT[t]).norm(), 1e-6) << t;
  }
}

// Rows of two targets on different links, some of them seen from another place.
Evidence seen_from_two_places(test::Random& random) {
  Evidence evidence;
  evidence.arm = test::puma();
  evidence.free_scale = true;
  evidence.free_gain = 0b101;
  for (std::size_t k = 0; k < 90; ++k) {
    EvidenceRow row;
    row.sweep = k % 3 == 0 ? 3 : 0;
    row.target = k % 3 == 0 ? 2 : 1;
    row.q = random.configuration(evidence.arm);
    row.p_S = random.normal_vector(1.0);
    row.moved = k % 4 == 1;
    evidence.rows.push_back(row);
  }
  return evidence;
}

// By how much the rows of twice the weights have more than those of the weights: no prior.
DeviatingChain::Normal of_rows_alone(const DeviatingChain& chain, const Evidence& evidence,
                                     const std::vector<Vector3>& residuals,
                                     std::vector<double> weights) {
  const DeviatingChain::Normal once = chain.normal(evidence, residuals, weights);
  for (double& weight : weights) weight *= 2;
  DeviatingChain::Normal rows = chain.normal(evidence, residuals, weights);
  rows.H -= once.H;
  rows.g -= once.g;
  return rows;
}

void expect_products_of_derivatives(const Evidence& evidence, test::Random& random,
                                    bool rejects = true) {
  DeviatingChain chain(evidence, {});
  chain.place(kBase, {{0.1, -0.02, 0.2}, {-0.05, 0.12, 0.03}});
  Eigen::VectorXd step = Eigen::VectorXd::Zero(chain.all().count);
  for (double& x : step) x = random.normal(1e-3);
  chain.move(step);
  const std::vector<Vector3> residuals = chain.residuals(evidence);
  std::vector<double> weights;
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    weights.push_back(rejects && k % 7 == 0 ? 0 : 1 + static_cast<double>(k % 5));
  }
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(step.size(), step.size());
  Eigen::VectorXd g = Eigen::VectorXd::Zero(step.size());
  Eigen::Matrix3Xd J(3, step.size());
  for (std::size_t k = 0; k < evidence.rows.size(); ++k) {
    chain.derivatives(evidence.rows[k], J);
    if (!evidence.free_scale) J.col(chain.of_lengths().first).setZero();
    H += weights[k] * J.transpose() * J;
    g += weights[k] * J.transpose() * residuals[k];
  }
  const DeviatingChain::Normal rows = of_rows_alone(chain, evidence, residuals, weights);
  EXPECT_LT((rows.H - H).norm(), 1e-9 * H.norm());
  EXPECT_LT((rows.g - g).norm(), 1e-9 * g.norm());
}

TEST(DeviatingChain, has_normal_equations_that_are_the_products_of_its_derivatives) {
  test::Random random(42);
  Evidence evidence = seen_from_two_places(random);
  expect_products_of_derivatives(evidence, random);
  evidence.free_scale = false;
  evidence.free_gain = 0;
  expect_products_of_derivatives(evidence, random);
  for (EvidenceRow& row : evidence.rows) row.moved = false;
  expect_products_of_derivatives(evidence, random);
}

TEST(DeviatingChain, has_them_of_as_many_rows_as_are_summed_at_once) {
  test::Random random(43);
  Evidence evidence = seen_from_two_places(random);
  evidence.rows.resize(static_cast<std::size_t>(kRowsABatch));
  expect_products_of_derivatives(evidence, random, false);
}

}  // namespace
}  // namespace armsig::tool
