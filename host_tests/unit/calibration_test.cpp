// SPDX-License-Identifier: MIT
// The estimator of geometry, gravity and reading maps against arms whose truth is known.
#include <algorithm>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "host_tests/support/calibration_case.hpp"
#include "host_tests/support/dense_prior.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/known_arms.hpp"

namespace armsig::calibration {
namespace {

using test::Calibration;
using test::Cell;
using test::dense_prior;
using test::Log;
using test::Random;

constexpr double kSigma = 0.05e-3;
constexpr ModelParts kGeometry{.gravity = false, .maps = false};
constexpr ModelParts kWhole{};

Observation row_of(const JointVector& q, const Vector3& p_S) {
  Observation row;
  row.readings = q;
  row.p_S = p_S;
  return row;
}

Log measured(const Cell& cell, int poses, const test::Misbehaviour& m, Random& random) {
  Log log;
  for (int k = 0; k < poses; ++k) {
    const JointVector q = random.configuration(cell.arm);
    log.push_back(row_of(q, test::misbehaving_point(cell, q, m) + random.normal_vector(kSigma)));
  }
  return log;
}

double mean_error(const Calibration& fit, const Log& log) {
  double sum = 0;
  for (const auto& row : log) sum += (row.p_S - fit.predict(row.readings)).norm();
  return sum / static_cast<double>(log.size());
}

TEST(Engine, finds_an_exact_arm_exactly) {
  Random random(11);
  const Cell cell = test::puma_cell(random);
  Log log;
  test::add_poses(cell, 60, 0, random, log);
  Calibration fit(test::puma(), log, kGeometry);
  ASSERT_TRUE(fit.fit());
  Log others;
  test::add_poses(cell, 50, 0, random, others);
  EXPECT_LT(mean_error(fit, others), 1e-7);
}

// Gravity and waves move all joints, of one of which nobody sees what depends on its own reading.
TEST(Engine, gives_a_joint_that_stood_still_no_map_and_a_wide_doubt) {
  Random random(13);
  const Cell cell = test::puma_cell(random);
  const test::Misbehaviour m{.wave_rad = radians(0.02), .sag_rad_m = 1e-3};
  Log log;
  for (int k = 0; k < 400; ++k) {
    JointVector q = random.configuration(cell.arm);
    q[2] = 0.7 + random.uniform(-0.02, 0.02);
    log.push_back(row_of(q, test::misbehaving_point(cell, q, m) + random.normal_vector(kSigma)));
  }
  Calibration fit(test::puma(), log, kWhole);
  ASSERT_TRUE(fit.fit());
  const JointModel& still = fit.model().joints[2];
  EXPECT_TRUE(std::ranges::all_of(still.map, [](double c) { return c == 0; }));
  const auto largest = [](const JointModel& joint) { return std::ranges::max(joint.map); };
  EXPECT_GT(largest(fit.model().joints[1]), 0.5);
  // As wrong as the other readings: waves of 0.02 degrees, in hundredths.
  EXPECT_GT(still.map_variance[60], 0.5F);
  EXPECT_LT(still.map_variance[60], 16.0F);
}

TEST(Engine, finds_waves_of_readings_and_sag) {
  Random random(12);
  const Cell cell = test::puma_cell(random);
  const test::Misbehaviour m{.wave_rad = radians(0.02), .sag_rad_m = 1e-3};
  const Log log = measured(cell, 800, m, random);
  const Log others = measured(cell, 100, m, random);
  Calibration geometry(test::puma(), log, kGeometry);
  Calibration whole(test::puma(), log, kWhole);
  ASSERT_TRUE(geometry.fit());
  ASSERT_TRUE(whole.fit());
  EXPECT_GT(mean_error(geometry, others), 3 * mean_error(whole, others));
  // What the noise of the new measurement leaves, and a third more.
  EXPECT_LT(mean_error(whole, others), 1.33 * 1.6 * kSigma);
  EXPECT_NEAR(std::sqrt(whole.engine().scales().sigma_squared), kSigma, 0.25 * kSigma);
}

TEST(Engine, invents_nothing_where_there_is_nothing) {
  Random random(13);
  const Cell cell = test::puma_cell(random);
  const Log log = measured(cell, 200, {}, random);
  const Log others = measured(cell, 300, {}, random);
  Calibration geometry(test::puma(), log, kGeometry);
  Calibration whole(test::puma(), log, kWhole);
  ASSERT_TRUE(geometry.fit());
  ASSERT_TRUE(whole.fit());
  EXPECT_LT(mean_error(whole, others), 1.02 * mean_error(geometry, others));
}

TEST(Engine, does_not_depend_on_the_order_of_the_rows) {
  Random random(14);
  const Cell cell = test::puma_cell(random);
  Log log = measured(cell, 120, {.wave_rad = radians(0.02)}, random);
  Calibration fit(test::puma(), log, kWhole);
  std::reverse(log.begin(), log.end());
  std::rotate(log.begin(), log.begin() + 17, log.end());
  Calibration shuffled(test::puma(), log, kWhole);
  ASSERT_TRUE(fit.fit());
  ASSERT_TRUE(shuffled.fit());
  for (const auto& row : log) {
    EXPECT_LT((fit.predict(row.readings) - shuffled.predict(row.readings)).norm(), 1e-9);
  }
  const auto a = fit.held_out();
  const auto b = shuffled.held_out();
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->mean_m, b->mean_m, 1e-9);
  EXPECT_EQ(a->rows, 120U);
}

TEST(Engine, finds_by_steps_what_it_finds_in_one_go) {
  Random random(18);
  const Cell cell = test::puma_cell(random);
  Log log = measured(cell, 60, {.wave_rad = radians(0.02), .sag_rad_m = 1e-3}, random);
  for (std::size_t k = 0; k < log.size(); k += 7) log[k].p_S.x() += 5e-3;
  std::vector<Matrix3> relative;
  for (std::size_t k = 0; k < log.size(); ++k) {
    relative.emplace_back(Vector3(0.5, 1, 1 + 0.1 * static_cast<double>(k % 6)).asDiagonal());
  }
  Calibration whole(test::puma(), log, kWhole, relative, kSigma * kSigma);
  const auto found = whole.fit();
  ASSERT_TRUE(found);
  std::size_t fewer = SIZE_MAX;
  for (const std::size_t work : {std::size_t{1}, std::size_t{20'000}}) {
    Calibration stepped(test::puma(), log, kWhole, relative, kSigma * kSigma);
    const std::size_t steps = stepped.fit_by_steps(work);
    EXPECT_LT(steps, fewer);
    fewer = steps;
    const auto summary = stepped.engine().result();
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->rounds, found->rounds);
    EXPECT_EQ(summary->converged, found->converged);
    EXPECT_EQ(summary->rejected, found->rejected);
    EXPECT_EQ(summary->degrees_of_model, found->degrees_of_model);
    EXPECT_EQ(stepped.engine().scales().sigma_squared, whole.engine().scales().sigma_squared);
    Engine::Stated S;
    Engine::Stated of_whole;
    EXPECT_EQ(stepped.predict(log[1].readings, &S), whole.predict(log[1].readings, &of_whole));
    EXPECT_EQ(S.model, of_whole.model);
    EXPECT_EQ(stepped.model().joints[3].map_variance, whole.model().joints[3].map_variance);
  }
  // A pass over 60 rows that squares 45 columns each takes 12 steps of that work, a round some.
  EXPECT_GT(fewer, static_cast<std::size_t>(12 * found->rounds));
}

TEST(Engine, refuses_by_steps_a_log_without_a_row_to_fit) {
  Random random(19);
  const Cell cell = test::puma_cell(random);
  const Log log = measured(cell, 20, {}, random);
  Calibration fit(test::puma(), log, kWhole);
  fit.hold_out_everything();
  fit.fit_by_steps(1000);
  EXPECT_EQ(test::failure_of(fit.engine().result()), Error::kTooFewPoints);
}

TEST(Engine, finds_blunders_by_the_residuals_own_scale) {
  Random random(15);
  const Cell cell = test::puma_cell(random);
  Log log = measured(cell, 200, {.wave_rad = radians(0.01)}, random);
  for (std::size_t k = 0; k < log.size(); k += 5) {
    log[k].p_S += random.uniform(2e-3, 50e-3) * random.direction();
  }
  Calibration fit(test::puma(), log, kWhole);
  ASSERT_TRUE(fit.fit());
  std::size_t false_alarms = 0;
  for (const FitRow& row : fit.rows()) {
    if (row.index % 5 == 0) {
      EXPECT_EQ(row.weight, 0) << row.index;
    } else {
      false_alarms += row.weight == 0;
    }
  }
  EXPECT_LE(false_alarms, 3U);
}

// All unknowns at once, derivatives by differences: another way to the same optimum.
TEST(Engine, comes_near_the_joint_optimum_of_an_independent_solver) {
  Random random(16);
  const Cell cell = test::puma_cell(random);
  const test::Misbehaviour m{.wave_rad = radians(0.02), .sag_rad_m = 0.5e-3};
  const Log log = measured(cell, 150, m, random);
  Calibration fit(test::puma(), log, kWhole);
  ASSERT_TRUE(fit.fit());
  const Scales& s = fit.engine().scales();
  // Deviations, gravity, maps, base, target; their prior precisions.
  std::vector<double> precision;
  std::vector<double*> unknown;
  auto model = std::make_unique<ArmModel>(fit.model());
  Vector3 p_L = fit.target().p_L;
  const auto add = [&](double& x, double variance) {
    unknown.push_back(&x);
    precision.push_back(1 / variance);
  };
  for (JointModel& joint : model->joints) {
    for (std::size_t c = 0; c < 2; ++c) add(joint.deviation[c], s.rotation * 4e-6);
    for (std::size_t c = 2; c < 4; ++c) add(joint.deviation[c], s.shift * 1e-6);
    add(joint.deviation[4], s.zero * 1e-4);
  }
  for (GravityTerm& term : model->gravity) {
    add(term.coefficient, s.gravity * std::pow(radians(0.01), 2));
  }
  const std::size_t maps = unknown.size();
  for (JointModel& joint : model->joints) {
    for (double& c : joint.map) add(c, 1);
  }
  const std::size_t free = unknown.size();
  const auto size = static_cast<Eigen::Index>(free + 9);
  const auto predict = [&](const JointVector& q) {
    ChainFrames frames;
    evaluate_chain(*model, q, 6, frames);
    return Vector3(frames.X_SL * p_L);
  };
  const auto jacobian = [&](const JointVector& q) {
    Eigen::MatrixXd J(3, size);
    const Vector3 at = predict(q);
    for (std::size_t k = 0; k < free; ++k) {
      const double step = k < maps ? 1e-6 : 1e-2;
      *unknown[k] += step;
      J.col(static_cast<Eigen::Index>(k)) = (predict(q) - at) / step;
      *unknown[k] -= step;
    }
    ChainFrames frames;
    evaluate_chain(*model, q, 6, frames);
    for (Eigen::Index c = 0; c < 3; ++c) {
      J.col(size - 9 + c) = Vector3::Unit(c).cross(at - model->X_SB.p);
      J.col(size - 6 + c) = Vector3::Unit(c);
      J.col(size - 3 + c) = frames.X_SL.R.col(c);
    }
    return J;
  };
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd g = Eigen::VectorXd::Zero(size);
  const Eigen::MatrixXd Q = dense_prior();
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(maps); ++k) {
    H(k, k) = precision[static_cast<std::size_t>(k)];
    g[k] = -H(k, k) * *unknown[static_cast<std::size_t>(k)];
  }
  for (Eigen::Index j = 0; j < 6; ++j) {
    const auto first = static_cast<Eigen::Index>(maps) + j * static_cast<Eigen::Index>(kKnots);
    const Eigen::Map<const Eigen::VectorXd> c(model->joints[static_cast<std::size_t>(j)].map.data(),
                                              kKnots);
    const double variance = s.map[static_cast<std::size_t>(j)];
    H.block(first, first, kKnots, kKnots) = Q / variance;
    g.segment(first, kKnots) = -(Q * c) / variance;
  }
  H.diagonal().tail(9).array() += 0.1;
  double squares = 0;
  for (const auto& row : log) {
    const Eigen::MatrixXd J = jacobian(row.readings);
    const Vector3 r = row.p_S - predict(row.readings);
    squares += r.squaredNorm() / s.sigma_squared;
    H += J.transpose() * J / s.sigma_squared;
    g += J.transpose() * r / s.sigma_squared;
  }
  const Eigen::VectorXd x = H.ldlt().solve(g);
  // What the joint optimum still gains of the cost, and how far it moves new predictions.
  EXPECT_LT(0.5 * g.dot(x), 0.05 * squares);
  double moved = 0;
  const Log others = measured(cell, 50, m, random);
  for (const auto& row : others) moved += (jacobian(row.readings) * x).squaredNorm() / 150;
  EXPECT_LT(std::sqrt(moved), 0.3 * std::sqrt(s.sigma_squared));
}

}  // namespace
}  // namespace armsig::calibration
