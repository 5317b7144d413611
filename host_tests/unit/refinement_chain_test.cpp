// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "core/calibration/chain.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

using test::Cell;
using test::Random;

// With a prismatic joint and a coupled elbow: every branch of the chain.
Cell coupled_cell(Random& random) {
  Cell cell = test::mixed_cell(random);
  cell.arm.couplings.push_back({2, 1, 0.7});
  return cell;
}

ReadingModel readings_of(const Cell& cell) { return {cell.arm.couplings, {}}; }

TEST(Chain, agrees_with_the_denavit_hartenberg_product_at_any_readings) {
  Random random(2);
  const Cell cell = coupled_cell(random);
  const JointVector configuration = random.configuration(cell.arm);
  const PoeChain chain(test::signature_of(cell, configuration), readings_of(cell));
  const Signature signature = test::signature_of(cell, configuration);
  for (int k = 0; k < 20; ++k) {
    const JointVector q = random.configuration(cell.arm);
    const Vector3 p = chain.point(chain.motion(q), signature.targets[0]);
    EXPECT_LT((p - cell.point(q, 0)).norm(), 1e-13);
  }
}

TEST(Chain, joints_beyond_the_targets_link_do_not_move_it) {
  Random random(3);
  const Cell cell = coupled_cell(random);
  const JointVector configuration = random.configuration(cell.arm);
  Signature signature = test::signature_of(cell, configuration);
  signature.targets[0].link = 2;
  const PoeChain chain(signature, readings_of(cell));
  JointVector q = configuration;
  q[2] += 1;
  q[5] += 1;
  const Vector3 p = chain.point(chain.motion(q), signature.targets[0]);
  EXPECT_LT((p - signature.targets[0].p_S).norm(), 1e-14);
}

// Every derivative against the difference of two corrected estimates.
TEST(Chain, derivatives_by_every_unknown_are_those_of_the_corrected_estimate) {
  Random random(4);
  const Cell cell = coupled_cell(random);
  const Signature signature = test::signature_of(cell, random.configuration(cell.arm));
  ReadingModel readings = readings_of(cell);
  readings.corrections.resize(6, {1e-3, 2e-3, -1e-3, 5e-4, 3e-4});
  ParameterRequest request;
  request.readings.resize(6, {true, true, true});
  const Layout layout = make_layout(signature, {true}, request, 0).value();
  ASSERT_EQ(layout.size(), 5U * 4 + 2 + 6 + 5 * 4 + 3);

  const JointVector q = random.configuration(cell.arm);
  const PoeChain chain(signature, readings);
  const JointMotion motion = chain.motion(q);
  PointJacobian jacobian;
  chain.point_and_jacobian(motion, signature.targets[0], jacobian);
  RowBlock<3> rows;
  rows.clear(layout.size());
  add_derivatives(layout, signature, chain, motion, 0, jacobian, rows);

  constexpr double kStep = 1e-5;
  for (std::size_t i = 0; i < layout.size(); ++i) {
    std::array<Vector3, 2> p;
    for (int side = 0; side < 2; ++side) {
      StateVector x{};
      x[i] = side == 0 ? -kStep : kStep;
      Signature moved = signature;
      ReadingModel corrected = readings;
      apply_corrections(layout, x, 1, moved, corrected);
      const PoeChain moved_chain(moved, corrected);
      p[side] = moved_chain.point(moved_chain.motion(q), moved.targets[0]);
    }
    const Vector3 slope = (p[1] - p[0]) / (2 * kStep);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(rows.rows[k][i], slope[k], 1e-8) << "unknown " << i;
  }
}

TEST(Chain, a_correction_moves_the_last_link_frame_with_its_axis) {
  Random random(5);
  const Cell cell = coupled_cell(random);
  const Signature signature = test::signature_of(cell, random.configuration(cell.arm));
  const Layout layout = make_layout(signature, {true}, {}, 0).value();
  StateVector x{};
  x.fill(1e-3);
  Signature moved = signature;
  ReadingModel readings;
  apply_corrections(layout, x, 1, moved, readings);
  const Pose before = signature.X_SL[5].inverse() * signature.X_SL[6];
  const Pose after = moved.X_SL[5].inverse() * moved.X_SL[6];
  EXPECT_LT((before.p - after.p).norm(), 1e-15);
  EXPECT_LT(angle_between(before.R, after.R), 1e-15);
}

TEST(Chain, turns_no_slide_and_leaves_a_target_at_rest_exactly_where_it_was) {
  Random random(8);
  const Cell cell = coupled_cell(random);
  const Signature signature = test::signature_of(cell, random.configuration(cell.arm));
  const PoeChain chain(signature, readings_of(cell));
  const JointMotion motion = chain.motion(random.configuration(cell.arm));
  // However far it goes.
  EXPECT_EQ(signature.types[3], JointType::kPrismatic);
  EXPECT_NE(motion.joints[3].moved, 0);
  EXPECT_EQ(motion.joints[3].cosine, 1);
  EXPECT_EQ(motion.joints[3].sine, 0);
  const JointMotion at_rest =
      chain.motion(readings_for(cell.arm.couplings, signature.configuration));
  EXPECT_EQ(chain.point(at_rest, signature.targets[0]), signature.targets[0].p_S);
}

TEST(Chain, a_target_that_is_no_unknown_adds_to_none) {
  Random random(9);
  const Cell cell = coupled_cell(random);
  const Signature signature = test::signature_of(cell, random.configuration(cell.arm));
  const Layout all = make_layout(signature, {true}, {}, 0).value();
  const Layout axes = make_layout(signature, {false}, {}, 0).value();
  ASSERT_EQ(axes.size() + 3, all.size());
  const PoeChain chain(signature, readings_of(cell));
  const JointMotion motion = chain.motion(random.configuration(cell.arm));
  PointJacobian jacobian;
  chain.point_and_jacobian(motion, signature.targets[0], jacobian);
  RowBlock<3> with_target;
  RowBlock<3> without;
  with_target.clear(all.size());
  without.clear(all.size());
  add_derivatives(all, signature, chain, motion, 0, jacobian, with_target);
  add_derivatives(axes, signature, chain, motion, 0, jacobian, without);
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      EXPECT_EQ(without.rows[c][i], i < axes.size() ? with_target.rows[c][i] : 0) << i;
    }
  }
}

TEST(Layout, counts_four_unknowns_a_revolute_axis_two_a_prismatic_one_three_a_target) {
  Random random(6);
  const Signature signature = test::signature_of(coupled_cell(random), test::cell_configuration());
  EXPECT_EQ(make_layout(signature, {true}, {}, 0)->size(), 25U);
  ParameterRequest request;
  request.receiver_offsets = true;
  request.scale = true;
  EXPECT_EQ(make_layout(signature, {true}, request, 4)->size(), 30U);
  EXPECT_EQ(make_layout(signature, {true}, request, 0)->size(), 26U);
}

TEST(Layout, says_how_many_unknowns_are_too_many) {
  Random random(7);
  const Signature signature = test::signature_of(coupled_cell(random), test::cell_configuration());
  std::array<bool, kMaxTargets> all{};
  all.fill(true);
  const auto layout = make_layout(signature, all, {}, 0);
  ASSERT_FALSE(layout);
  EXPECT_EQ(test::failure_of(layout).error, Error::kCapacityExceeded);
  EXPECT_EQ(test::failure_of(layout).found, 22 + 3.0 * kMaxTargets);
}

TEST(Readings, coupling_adds_the_raw_reading_of_the_other_joint) {
  ReadingModel model;
  model.couplings.push_back({2, 1, -1.0});
  const JointVector coupled = true_readings(model, {0, 0, 0}, {0.1, 0.2, 0.7});
  EXPECT_EQ(coupled[0], 0.1);
  EXPECT_EQ(coupled[1], 0.2);
  EXPECT_DOUBLE_EQ(coupled[2], 0.5);
}

TEST(Readings, corrections_vanish_at_the_signature_configuration_and_can_be_undone) {
  ReadingModel model;
  model.corrections.push_back({0.01, 0.002, 0.003, 0.004, 0.005});
  model.corrections.push_back({-0.02, 0, 0, 0.01, 0});
  const JointVector configuration{0.5, -1.2};
  const JointVector at_rest = true_readings(model, configuration, configuration);
  EXPECT_DOUBLE_EQ(at_rest[0], 0.5);
  EXPECT_DOUBLE_EQ(at_rest[1], -1.2);
  const JointVector readings{1.7, 2.9};
  const JointVector back =
      encoder_readings(model, configuration, true_readings(model, configuration, readings));
  EXPECT_NEAR(back[0], 1.7, 1e-14);
  EXPECT_NEAR(back[1], 2.9, 1e-14);
}

TEST(Readings, correction_is_gain_and_two_harmonics) {
  ReadingModel model;
  model.corrections.push_back({0.01, 0.002, 0.003, 0.004, 0.005});
  // 0.5 * 1.01 + 0.002 cos 0.5 + 0.003 sin 0.5 + 0.004 cos 1 + 0.005 sin 1, by a pocket calculator.
  EXPECT_NEAR(corrected_reading(model, 0, 0.5), 0.5145620, 5e-8);
}

TEST(Chain, corrections_leave_what_is_no_unknown) {
  Random random(10);
  const Cell cell = coupled_cell(random);
  Signature signature = test::signature_of(cell, random.configuration(cell.arm));
  const Vector3 target = signature.targets[0].p_S;
  ReadingModel readings = readings_of(cell);
  readings.corrections.resize(6, {.gain = 0.5});
  ParameterRequest request;
  request.readings.resize(6, ReadingTerms{.first = true});
  const Layout layout = make_layout(signature, {false}, request, 0).value();
  StateVector x{};
  x.fill(1e-3);
  apply_corrections(layout, x, 1, signature, readings);
  EXPECT_EQ(readings.corrections[0].gain, 0.5);
  EXPECT_EQ(readings.corrections[0].cos_1, 1e-3);
  EXPECT_EQ(signature.targets[0].p_S, target);
}

TEST(Chain, turns_as_far_as_readings_go) {
  Random random(11);
  const Cell cell = test::puma_cell(random);
  const JointVector configuration = random.configuration(cell.arm);
  const Signature signature = test::signature_of(cell, configuration);
  const PoeChain chain(signature, {});
  JointVector q = random.configuration(cell.arm);
  const Vector3 near = chain.point(chain.motion(q), signature.targets[0]);
  q[0] += 2 * kPi * 1e6;  // beyond what sines by lanes are good for
  EXPECT_LT((chain.point(chain.motion(q), signature.targets[0]) - near).norm(), 1e-8);
}

}  // namespace
}  // namespace armsig::calibration
