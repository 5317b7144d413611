// SPDX-License-Identifier: MIT
// What the estimator of geometry, gravity and reading maps is made of, against dense algebra.
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/calibration/cyclic_band.hpp"
#include "core/calibration/fit_row.hpp"
#include "core/calibration/gravity_choice.hpp"
#include "core/calibration/model.hpp"
#include "host_tests/support/dense_prior.hpp"
#include "host_tests/support/known_arms.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::dense_prior;
using test::Random;

TEST(ReadingMap, has_a_prior_of_unit_point_deviation_everywhere) {
  const Eigen::MatrixXd C = dense_prior().inverse();
  const MapDomain domain = map_domain(JointType::kRevolute, {});
  for (const double q : {-7.0, -0.013, 0.0, 0.026, 1.0, 3.14159, 40.0}) {
    const SplineSupport at = spline_support(domain, q);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(kKnots);
    for (std::size_t k = 0; k < kSplines; ++k) {
      b[static_cast<Eigen::Index>(at.knot(k))] += at.weight[k];
    }
    EXPECT_NEAR(b.sum(), 1, 1e-12);
    EXPECT_NEAR(b.dot(C * b), 1, 0.03) << q;
  }
}

// What the coefficients of every map that is stored are told in.
TEST(ReadingMap, counts_in_hundredths_of_a_degree_or_tenths_of_a_millimetre) {
  EXPECT_DOUBLE_EQ(degrees(map_unit(JointType::kRevolute)), 0.01);
  EXPECT_DOUBLE_EQ(map_unit(JointType::kPrismatic), 1e-4);
}

TEST(ReadingMap, goes_on_smoothly_over_its_knots_and_its_turn) {
  Random random(3);
  MapCoefficients c;
  for (double& x : c) x = random.normal(1);
  const MapDomain domain = map_domain(JointType::kRevolute, {});
  const auto value = [&](double q) { return map_value(c, spline_support(domain, q)); };
  for (const double q : {0.0, 2 * kPi, -2 * kPi, 2 * kPi / kKnots * 17}) {
    EXPECT_NEAR(value(q - 1e-9), value(q + 1e-9), 1e-7);
    EXPECT_NEAR((value(q) - value(q - 1e-5)) / 1e-5, (value(q + 1e-5) - value(q)) / 1e-5, 0.05);
  }
  EXPECT_NEAR(value(0.7), value(0.7 + 4 * kPi), 1e-12);
}

TEST(CyclicFactor, solves_and_inverts_as_dense_algebra_does) {
  Random random(5);
  CyclicBand band{};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(kKnots, kKnots);
  for (int row = 0; row < 300; ++row) {
    const SplineSupport at =
        spline_support(map_domain(JointType::kRevolute, {}), random.uniform(-4, 4));
    for (std::size_t a = 0; a < kSplines; ++a) {
      for (std::size_t b = a; b < kSplines; ++b) {
        band[at.knot(a)][b - a] += static_cast<float>(at.weight[a] * at.weight[b]);
      }
    }
  }
  for (std::size_t i = 0; i < kKnots; ++i) {
    for (std::size_t k = 0; k < kSplines; ++k) {
      const auto a = static_cast<Eigen::Index>(i);
      const auto b = static_cast<Eigen::Index>((i + k) % kKnots);
      A(a, b) = A(b, a) = static_cast<double>(band[i][k]) / 0.3;
    }
  }
  A += dense_prior() / 2.5;
  CyclicFactor factor;
  factor.factorise(band, 0.3, map_prior(), 2.5);
  MapCoefficients b;
  Eigen::VectorXd dense(kKnots);
  for (std::size_t i = 0; i < kKnots; ++i) {
    dense[static_cast<Eigen::Index>(i)] = b[i] = random.normal(1);
  }
  factor.solve(b);
  const Eigen::VectorXd x = A.ldlt().solve(dense);
  for (std::size_t i = 0; i < kKnots; ++i) {
    EXPECT_NEAR(b[i], x[static_cast<Eigen::Index>(i)], 1e-9 * x.norm());
  }
  CyclicBand inverse;
  factor.invert(inverse);
  const Eigen::MatrixXd C = A.inverse();
  for (std::size_t i = 0; i < kKnots; ++i) {
    for (std::size_t k = 0; k < kSplines; ++k) {
      EXPECT_NEAR(static_cast<double>(inverse[i][k]),
                  C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>((i + k) % kKnots)),
                  1e-6 * C(0, 0));
    }
  }
}

TEST(GravityTerms, are_those_that_a_drawing_can_tell_apart) {
  const Arm arm = test::ur5();
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  EXPECT_EQ(model.gravity.size(), 10U);
  for (const GravityTerm& term : model.gravity) {
    EXPECT_GT(term.joint, 0) << "the first joint's axis is vertical";
  }
}

// On a wall the first joint carries the arm too.
TEST(GravityTerms, are_those_of_all_joints_where_the_first_is_not_vertical) {
  Arm arm = test::ur5();
  arm.up_0 = Vector3::UnitX();
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  EXPECT_GT(model.gravity.size(), 10U);
  EXPECT_LE(model.gravity.size(), most_gravity_terms(6));
  EXPECT_EQ(model.gravity[0].joint, 0);
  arm.up_0 = -Vector3::UnitZ();
  model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  EXPECT_EQ(model.gravity.size(), 10U) << "on the ceiling";
}

TEST(GravityTerms, are_found_by_bounded_steps_and_no_more_than_there_is_room_for) {
  const Arm arm = test::ur5();
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  ArmModel stepped = model_of(arm, {});
  GravityChoice choice(arm, stepped, 7);
  int steps = 1;
  while (choice.step()) ++steps;
  EXPECT_EQ(steps, 6 * 20);
  ASSERT_EQ(stepped.gravity.size(), 7U);
  for (std::size_t k = 0; k < 7; ++k) {
    EXPECT_EQ(stepped.gravity[k].joint, model.gravity[k].joint);
    EXPECT_EQ(stepped.gravity[k].origin, model.gravity[k].origin);
  }
}

TEST(GroupPoses, keeps_repeated_readings_together_whatever_the_order) {
  Random random(7);
  std::vector<FitRow> rows;
  for (int pose = 0; pose < 40; ++pose) {
    JointVector q;
    for (int j = 0; j < 6; ++j) q.push_back(random.uniform(-2, 2));
    for (int repeat = 0; repeat < 3; ++repeat) {
      FitRow row;
      row.readings = q;
      row.readings[2] += radians(0.002) * repeat;
      row.p_S = random.normal_vector(1);
      row.index = static_cast<std::uint32_t>(pose);
      rows.push_back(row);
    }
  }
  std::vector<FitRow> other(rows.rbegin(), rows.rend());
  const std::vector<JointType> types(6, JointType::kRevolute);
  for (auto* sorted : {&rows, &other}) {
    group_poses(*sorted, types);
    EXPECT_EQ(deal_folds(*sorted), 40U);
  }
  std::array<int, kFolds> counts{};
  for (std::size_t k = 0; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k].index, rows[k / 3 * 3].index);
    EXPECT_EQ(rows[k].pose, k / 3);
    EXPECT_EQ(rows[k].index, other[k].index);
    EXPECT_EQ(rows[k].fold, other[k].fold);
    ++counts[rows[k].fold];
  }
  for (const int count : counts) EXPECT_EQ(count, 24);
}

// What a correction of the reading adds is linear in each of its coefficients.
TEST(TurnBy, is_what_one_unit_of_a_correction_adds) {
  constexpr std::uint8_t kElbow = 2;
  for (const Parameter& parameter : {Parameter{ParameterKind::kReadingGain, kElbow, 0},
                                     Parameter{ParameterKind::kReadingFirst, kElbow, 0},
                                     Parameter{ParameterKind::kReadingFirst, kElbow, 1},
                                     Parameter{ParameterKind::kReadingSecond, kElbow, 0},
                                     Parameter{ParameterKind::kReadingSecond, kElbow, 1}}) {
    ArmModel model = model_of(test::puma560(), {});
    value_of(model, parameter) = 1;
    for (const double reading : {-2.0, 0.3, 1.1}) {
      const double added = corrected(model.joints[kElbow].correction, reading) - reading;
      EXPECT_NEAR(turn_by(parameter, reading), added, 1e-15) << reading;
    }
  }
}

}  // namespace
}  // namespace armsig::calibration
