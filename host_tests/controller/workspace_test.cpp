// SPDX-License-Identifier: MIT
// What the controller does with what is around the arm: what it refuses before anything moves, what
// it leaves of the sweeps, and where `move` and `touch-grid` do not go.
#include "firmware/controller/workspace.hpp"

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "firmware/controller/pose_visit.hpp"
#include "firmware/controller/sweep.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/whole_configuration.hpp"

namespace armsig::controller {
namespace {

constexpr double kHand_m = 0.16;
const Vector3 kLower(-0.62, -0.62, -0.25);
const Vector3 kUpper(0.86, 0.74, 1.15);

Configuration in_box(const Vector3& lower = kLower, const Vector3& upper = kUpper) {
  Configuration c = test::whole_configuration();
  c.sweeps.arc_rad = radians(60);
  c.around = test::boxed(lower, upper, kHand_m);
  return c;
}

// Room between the box and the arm, by the frames of the drawing.
double room(const Configuration& c, const JointVector& q) {
  double least = 1e9;
  const auto frames = dh_frames(c.drawing.joints, q);
  for (std::size_t k = 1; k < frames.size(); ++k) {
    const double reach = k + 1 == frames.size() ? c.around.hand_m : 0;
    least = std::min({least, (frames[k].p - c.around.lower_B).minCoeff() - reach,
                      (c.around.upper_B - frames[k].p).minCoeff() - reach});
  }
  return least;
}

TEST(Workspace, that_holds_sweeps_and_configuration_is_accepted) { EXPECT_TRUE(check(in_box())); }

TEST(Workspace, is_refused_by_the_name_of_its_side) {
  for (const auto& [axis, name] :
       {std::pair(0, "workspace.x"), std::pair(1, "workspace.y"), std::pair(2, "workspace.z")}) {
    Configuration c = in_box();
    std::swap(c.around.lower_B[axis], c.around.upper_B[axis]);
    EXPECT_EQ(test::failure_of(check(c)).setting, name);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsReversed);
    c = in_box();
    c.around.upper_B[axis] = 900;
    EXPECT_EQ(test::failure_of(check(c)).setting, name);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  }
  Configuration c = in_box();
  c.around.hand_m = 160;
  EXPECT_EQ(test::failure_of(check(c)).setting, "workspace.hand");
}

TEST(Workspace, without_room_for_the_signature_configuration_is_refused_with_link_and_place) {
  Configuration c = in_box();
  c.around.upper_B.z() = 0.9;
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "workspace");
  EXPECT_EQ(refusal.error, Error::kOutsideWorkspace);
  EXPECT_EQ(refusal.joint, 5U);
  const JointVector& home = c.sweeps.configuration;
  EXPECT_NEAR(refusal.found, room(c, home), 1e-12);
  EXPECT_EQ(refusal.room.limit, clearance::Limit::kBox);
  EXPECT_EQ(refusal.room.link, 7) << "what the flange carries";
  EXPECT_LT((refusal.room.p_B - dh_frames(c.drawing.joints, home).back().p).norm(), 1e-12);
}

TEST(Workspace, that_a_sweep_leaves_is_refused_with_the_joint_and_how_far_it_may_go) {
  Configuration c = in_box();
  c.sweeps.arc_rad = radians(120);
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.error, Error::kOutsideWorkspace);
  ASSERT_TRUE(refusal.joint);
  JointVector to = c.sweeps.configuration;
  to[*refusal.joint] = refusal.found;
  EXPECT_LT(room(c, to), kLeastRoom_m);
  to[*refusal.joint] = refusal.needed;
  EXPECT_NEAR(room(c, to), kLeastRoom_m, kLeastRoom_m / 2) << "as far as it may go";
}

// Once the sweeps are limited by it the same box is accepted, and each sweep moved or cut.
TEST(Workspace, limits_each_sweep_to_what_is_free) {
  Configuration c = in_box();
  c.sweeps.arc_rad = radians(120);
  limit_sweeps(c);
  ASSERT_TRUE(check(c));
  bool cut = false;
  bool moved = false;
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const JointLimits arc = planned_arc(c, joint);
    for (int k = 0; k <= 500; ++k) {
      JointVector q = c.sweeps.configuration;
      q[joint] = arc.lower + (arc.upper - arc.lower) * k / 500;
      EXPECT_GE(room(c, q), kLeastRoom_m / 2 - 1e-9) << "joint " << joint + 1;
    }
    const bool whole = arc.upper - arc.lower > radians(120) - 1e-9;
    cut = cut || !whole;
    const double middle = (arc.upper + arc.lower) / 2;
    moved = moved || (whole && std::abs(middle - c.sweeps.configuration[joint]) > 0.01);
    // And is extended no farther.
    Sweep sweep(c, joint);
    for (; sweep.next(); sweep.skip()) {
      JointVector q = c.sweeps.configuration;
      q[joint] = *sweep.next();
      EXPECT_GE(room(c, q), kLeastRoom_m / 2 - 1e-9) << "joint " << joint + 1;
    }
  }
  EXPECT_TRUE(cut || moved) << "the box would leave all as it is";
}

TEST(Workspace, that_leaves_too_little_of_a_sweep_is_refused_with_the_joint) {
  Configuration c = in_box();
  // The hand is upright over the shoulder and reaches 0.16: joint 2 tilts it by 4 degrees.
  c.around.lower_B.x() = -0.25;
  c.around.upper_B.x() = 0.2;
  limit_sweeps(c);
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "sweeps.configuration");
  EXPECT_EQ(refusal.error, Error::kOutsideWorkspace);
  EXPECT_EQ(refusal.joint, 1U);
  EXPECT_LT(refusal.found, radians(30));
  EXPECT_DOUBLE_EQ(refusal.needed, radians(30));
}

TEST(Workspace, arcs_differ_by_joint) {
  Configuration c = test::whole_configuration();
  c.sweeps.arcs_rad = {radians(60), radians(90), radians(120),
                       radians(40), radians(50), radians(300)};
  ASSERT_TRUE(check(c));
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const auto [lower, upper] = planned_arc(c, joint);
    const auto& limits = c.drawing.limits[joint];
    EXPECT_NEAR(upper - lower, std::min(c.sweeps.arcs_rad[joint], limits.upper - limits.lower),
                1e-12);
  }
  c.sweeps.arcs_rad[2] = 7;
  EXPECT_EQ(test::failure_of(check(c)).setting, "sweeps.arc");
}

TEST(Workspace, turns_a_sweep_back_on_the_side_that_leaves_it) {
  Configuration c = test::whole_configuration();
  c.sweeps.points = 12;
  Sweep sweep(c, 0);
  double last = *sweep.next();
  while (*sweep.next() >= last) {
    last = *sweep.next();
    if (sweep.done() == 14) {
      sweep.turn_back();
    } else {
      sweep.skip();
    }
  }
  EXPECT_EQ(sweep.done(), 14U);
  EXPECT_LT(*sweep.next(), *Sweep(c, 0).next()) << "goes on before the first";
  EXPECT_NEAR(planned_arc(c, 0).lower, *Sweep(c, 0).next(), 1e-12);
}

// The floor of a Puma, 672 mm below its shoulder, and its links.
Configuration on_its_floor() {
  Configuration c = test::puma_controller();
  c.around = clearance::surroundings_of(c.drawing, {.floor_m = 0.672});
  c.around.hand_m = kHand_m;
  limit_sweeps(c);
  return c;
}

TEST(Workspace, is_kept_by_moves_of_the_joints_on_the_whole_way) {
  test::PumaCabinet puma(1, on_its_floor());
  ASSERT_TRUE(puma.enable());
  // Straight down, through the floor; and, by way of that, to the other side of it.
  for (const char* const request :
       {"move q2_deg=45 q3_deg=90", "move q1_deg=5 q2_deg=44 q3_deg=90 q5_deg=5"}) {
    const std::string refused = puma.ask(request);
    EXPECT_TRUE(refused.contains("OUTSIDE_WORKSPACE")) << refused;
    EXPECT_TRUE(refused.contains(" link=7 near=floor room_mm=")) << refused;
    EXPECT_TRUE(refused.contains(" z_mm=-")) << refused;
  }
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  EXPECT_EQ(puma.ask("move q2_deg=-60"), "ok");
}

TEST(Workspace, is_kept_by_straight_lines) {
  test::PumaCabinet puma(1, on_its_floor());
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("move q2_deg=-60 q3_deg=190 q4_deg=0 q5_deg=30"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kServoing, 1) && puma.run_until(Mode::kHolding, 60));
  puma.ask("acknowledge drawing");
  const std::string refused = puma.ask("move dz_mm=-640");
  EXPECT_TRUE(refused.contains("OUTSIDE_WORKSPACE")) << refused;
  EXPECT_TRUE(refused.contains(" near=floor ")) << refused;
}

TEST(Workspace, is_kept_by_the_grid_before_the_arm_moves) {
  Configuration c = on_its_floor();
  c.grid.grid.size_m = {0.05, 0.05, 0.05};
  c.grid.grid.count = {2, 2, 2};
  const JointVector low{0, radians(45), radians(110), 0, radians(30), 0};
  ASSERT_LT(room_at(c, low).left_m, 0);
  c.grid.taught = {low, low, low};
  c.grid.taught[1][0] += 0.1;
  c.grid.taught[2][1] -= 0.1;
  test::PumaCabinet puma(1, c);
  ASSERT_TRUE(puma.enable());
  puma.ask("acknowledge drawing");
  const JointVector before = puma.now().commanded;
  puma.ask("touch-grid");
  puma.run(2);
  bool told = false;
  for (const std::string& line : puma.console.told) {
    told = told || line.contains("touch-grid finds no way link=");
  }
  EXPECT_TRUE(told);
  EXPECT_EQ(puma.mode(), Mode::kHolding);
  EXPECT_EQ(puma.now().commanded[1], before[1]);
}

}  // namespace
}  // namespace armsig::controller
