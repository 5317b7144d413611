// SPDX-License-Identifier: MIT
// The workspace box: what is looked at before anything moves, against places along the way, close
// to each other, of a chain that is multiplied out here.
#include "firmware/controller/workspace.hpp"

#include <gtest/gtest.h>

#include "core/base/links.hpp"
#include "firmware/controller/pose_visit.hpp"
#include "firmware/controller/sweep.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/simulated_arm.hpp"
#include "host_tests/support/whole_configuration.hpp"

namespace armsig::controller {
namespace {

constexpr double kHand_m = 0.16;

Configuration in_box(const Vector3& lower, const Vector3& upper) {
  Configuration c = test::whole_configuration();
  c.sweeps.arc_rad = radians(60);
  c.workspace = WorkspaceBox{lower, upper, kHand_m};
  return c;
}

const Vector3 kLower(-0.62, -0.62, -0.25);
const Vector3 kUpper(0.86, 0.74, 1.15);

// Least room at the places of a way, `places` of them, by the frames of the drawing.
double least_room(const Configuration& c, const JointVector& from, const JointVector& to,
                  int places = 2000) {
  double least = 1e9;
  for (int place = 0; place <= places; ++place) {
    JointVector q = from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += (to[i] - from[i]) * place / places;
    const auto frames = dh_frames(c.drawing.joints, q);
    for (std::size_t k = 1; k < frames.size(); ++k) {
      const double reach = k + 1 == frames.size() ? c.workspace->hand_m : 0;
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        least = std::min({least, frames[k].p[axis] - c.workspace->lower[axis] - reach,
                          c.workspace->upper[axis] - frames[k].p[axis] - reach});
      }
    }
  }
  return least;
}

WayLook::Says whole_look(const Configuration& c, const JointVector& from, const JointVector& to) {
  WayLook look;
  auto says = WayLook::Says::kMore;
  for (int i = 0; i < 1000 && says == WayLook::Says::kMore; ++i) says = look.step(c, from, to);
  return says;
}

// How many ways were clear, and how many left the box: both as their places say, but for those that
// come too near to say.
struct Ways {
  int clear = 0;
  int leaving = 0;

  void look(const Configuration& c, const JointVector& from, const JointVector& to) {
    const double room = least_room(c, from, to);
    const auto says = whole_look(c, from, to);
    if (room < kLeastRoom_m - 1e-9) {
      EXPECT_EQ(says, WayLook::Says::kLeaves) << "room " << room;
      ++leaving;
    } else if (room > kLeastRoom_m + 2e-3) {
      EXPECT_EQ(says, WayLook::Says::kClear) << "room " << room;
      ++clear;
    }
  }
};

TEST(Workspace, is_left_by_a_way_where_its_places_leave_it) {
  const Configuration c = in_box(kLower, kUpper);
  Ways ways;
  for (std::size_t n = 0; n < 200; ++n) {
    ways.look(c, spread_pose(c, 2 * n), spread_pose(c, 2 * n + 1));
  }
  EXPECT_GT(ways.clear, 30);
  EXPECT_GT(ways.leaving, 30);
}

TEST(Workspace, is_not_there_where_none_is_told) {
  Configuration c = in_box(kLower, kUpper);
  c.workspace.reset();
  WayLook look;
  EXPECT_EQ(look.step(c, spread_pose(c, 1), spread_pose(c, 2)), WayLook::Says::kClear);
}

TEST(Workspace, of_a_slide_counts_its_way) {
  Configuration c;
  c.drawing.joints = {{.type = JointType::kPrismatic}};
  c.workspace = WorkspaceBox{{-1, -1, -0.1}, {1, 1, 0.5}, 0};
  EXPECT_EQ(whole_look(c, {0.0}, {0.49}), WayLook::Says::kClear);
  EXPECT_EQ(whole_look(c, {0.0}, {0.6}), WayLook::Says::kLeaves);
  EXPECT_EQ(whole_look(c, {0.0}, {-0.2}), WayLook::Says::kLeaves);
}

// A turning joint, a slide across its axis, a turning hand: where the slide is out, a turn of the
// first joint carries what is behind it far.
TEST(Workspace, is_left_by_a_way_of_an_arm_with_a_slide_where_its_places_leave_it) {
  Configuration c;
  c.drawing = test::make_arm(
      {{test::kR, 0, 0, 0, kPi / 2}, {test::kP, 0, 0.1, 0.02, 0}, {test::kR, 0, 0.05, 0.15, 0}},
      {{-3, 3}, {-0.3, 0.8}, {-3, 3}});
  c.workspace = WorkspaceBox{{-0.7, -0.7, -0.5}, {0.7, 0.7, 0.5}, 0.05};
  test::Random random(5);
  Ways ways;
  for (int n = 0; n < 300; ++n) {
    ways.look(c, random.configuration(c.drawing), random.configuration(c.drawing));
  }
  EXPECT_GT(ways.clear, 30);
  EXPECT_GT(ways.leaving, 30);
}

// Some turns about the vertical, of which a look that took the slide for short would skip each.
TEST(Workspace, is_left_by_turns_with_a_slide_that_is_out_at_one_end_of_the_way) {
  for (const double offset_m : {0.0, 0.4}) {
    Configuration c;
    c.drawing.joints = {{.type = JointType::kRevolute, .alpha_rad = kPi / 2},
                        {.type = JointType::kPrismatic, .d_m = offset_m}};
    c.workspace = WorkspaceBox{{-2, -2, -1}, {0.3, 2, 1}, 0};
    const double out = 0.8 - offset_m;
    const double in = -offset_m;
    EXPECT_EQ(whole_look(c, {0.0, out}, {16.9, in}), WayLook::Says::kLeaves);
    EXPECT_EQ(whole_look(c, {16.9, in}, {0.0, out}), WayLook::Says::kLeaves);
  }
}

TEST(Workspace, that_holds_sweeps_and_configuration_is_accepted) {
  EXPECT_TRUE(check(in_box(kLower, kUpper)));
}

TEST(Workspace, is_refused_by_the_name_of_its_side) {
  for (const auto& [axis, name] :
       {std::pair(0, "workspace.x"), std::pair(1, "workspace.y"), std::pair(2, "workspace.z")}) {
    Configuration c = in_box(kLower, kUpper);
    std::swap(c.workspace->lower[axis], c.workspace->upper[axis]);
    EXPECT_EQ(test::failure_of(check(c)).setting, name);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsReversed);
    c = in_box(kLower, kUpper);
    c.workspace->upper[axis] = 900;
    EXPECT_EQ(test::failure_of(check(c)).setting, name);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  }
  Configuration c = in_box(kLower, kUpper);
  c.workspace->hand_m = 160;
  EXPECT_EQ(test::failure_of(check(c)).setting, "workspace.hand");
}

TEST(Workspace, without_room_for_the_signature_configuration_is_refused_with_the_joint) {
  Configuration c = in_box(kLower, kUpper);
  c.workspace->upper.z() = 0.9;
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "workspace");
  EXPECT_EQ(refusal.error, Error::kOutsideWorkspace);
  EXPECT_EQ(refusal.joint, 5U);
  const JointVector& home = c.sweeps.configuration;
  EXPECT_NEAR(refusal.found, least_room(c, home, home, 1), 1e-12);
}

TEST(Workspace, that_a_sweep_leaves_is_refused_with_the_joint_and_how_far_it_may_go) {
  Configuration c = in_box(kLower, kUpper);
  c.sweeps.arc_rad = radians(120);
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.error, Error::kOutsideWorkspace);
  ASSERT_TRUE(refusal.joint);
  const JointVector& home = c.sweeps.configuration;
  JointVector to = home;
  to[*refusal.joint] = refusal.found;
  EXPECT_LT(least_room(c, home, to), kLeastRoom_m);
  to[*refusal.joint] = refusal.needed;
  EXPECT_NEAR(least_room(c, home, to), kLeastRoom_m, kLeastRoom_m / 2) << "as far as it may go";
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

}  // namespace
}  // namespace armsig::controller
