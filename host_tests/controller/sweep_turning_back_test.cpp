// SPDX-License-Identifier: MIT
// Where a sweep goes that may not go further out on a side, and the sweep of a slide.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/sweep.hpp"
#include "firmware/controller/workspace.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

// An arc of 40 degrees between limits of 50 on either side: -20, 0, 20, 40, -40, and in between.
Configuration narrow() {
  Configuration c = test::puma_controller();
  c.drawing.limits[0] = {radians(-50), radians(50)};
  c.sweeps.arc_rad = radians(40);
  c.sweeps.points = 3;
  c.sweeps.most_points = 30;
  return c;
}

// The places in degrees; the place with this number, from 1 on, can't be gone to.
std::vector<double> places(std::size_t turns_back_at) {
  const Configuration c = narrow();
  Sweep sweep(c, 0);
  std::vector<double> places;
  for (std::size_t i = 1; i < 100; ++i) {
    const auto next = sweep.next();
    if (!next) break;
    places.push_back(std::round(1e6 * degrees(*next)) / 1e6);
    if (i == turns_back_at) {
      sweep.turn_back();
    } else {
      sweep.skip();
    }
  }
  return places;
}

TEST(SweepTurnsBack, from_the_upper_side_and_goes_on_below_its_arc) {
  EXPECT_EQ(places(4), (std::vector<double>{-20, 0, 20, 40, -40, -30, -10, 10}));
}

TEST(SweepTurnsBack, from_the_lower_side_and_goes_on_in_between) {
  EXPECT_EQ(places(5), (std::vector<double>{-20, 0, 20, 40, -40, 30, 10, -10}));
}

TEST(SweepTurnsBack, from_a_place_in_between_to_the_next_one) {
  EXPECT_EQ(places(6), (std::vector<double>{-20, 0, 20, 40, -40, -30, -10, 10, 30}));
}

// A sweep that is not accurate enough goes on beyond its arc, until it comes to the box.
TEST(SweepTurnsBack, where_the_next_place_is_outside_of_the_workspace_box) {
  Configuration c = test::puma_controller();
  c.sweeps.arc_rad = radians(60);
  c.sweeps.points = 6;
  c.sweeps.most_points = 16;
  c.sweeps.axis_sigma_rad = 1e-6;
  c.sweeps.validation_poses = 3;
  c.around = test::boxed({-0.62, -0.62, -0.25}, {0.86, 0.74, 1.15}, 0.16);
  ASSERT_TRUE(check(c));
  std::size_t outside = 0;
  for (std::size_t joint = 0; joint < 6; ++joint) {
    Sweep sweep(c, joint);
    for (; sweep.next(); sweep.skip()) {
      JointVector q = c.sweeps.configuration;
      q[joint] = *sweep.next();
      if (room_at(c, q).left_m < kLeastRoom_m) ++outside;
    }
  }
  ASSERT_GT(outside, 0U) << "nothing would turn back";
  test::PumaCabinet puma(1, c);
  ASSERT_TRUE(puma.enable());
  ASSERT_EQ(puma.ask("identify"), "ok");
  ASSERT_TRUE(puma.run_until(Mode::kSweeping, 1));
  ASSERT_TRUE(puma.run_until(Mode::kHolding, 600));
  const IdentificationSequence& sequence = puma.cabinet->state().identification();
  EXPECT_TRUE(sequence.has_verdict());
  for (std::size_t i = 0; i < sequence.log().size(); ++i) {
    EXPECT_GE(room_at(c, sequence.log()[i].readings()).left_m, kLeastRoom_m - 1e-3) << i;
  }
}

TEST(SweepOfASlide, goes_between_its_limits_whatever_the_arc) {
  Configuration c = test::puma_controller();
  c.drawing.joints[2].type = JointType::kPrismatic;
  c.drawing.limits[2] = {0.1, 0.5};
  c.sweeps.arc_rad = 0.1;
  c.sweeps.points = 5;
  c.sweeps.most_points = 7;
  Sweep sweep(c, 2);
  EXPECT_NEAR(sweep.planned().lower, 0.1, 1e-15);
  EXPECT_NEAR(sweep.planned().upper, 0.5, 1e-15);
  for (const double place : {0.1, 0.2, 0.3, 0.4, 0.5, 0.45, 0.35}) {
    ASSERT_TRUE(sweep.next());
    EXPECT_NEAR(*sweep.next(), place, 1e-12);
    sweep.skip();
  }
  EXPECT_FALSE(sweep.next());
}

TEST(Sweep, of_more_than_a_turn_does_not_measure_its_first_place_again) {
  Configuration c = test::puma_controller();
  c.drawing.limits[5] = {radians(-270), radians(270)};
  c.sweeps.configuration[5] = 0;
  c.sweeps.arc_rad = radians(180);
  c.sweeps.points = 7;
  c.sweeps.most_points = 14;
  Sweep sweep(c, 5);
  for (const double place : {-90, -60, -30, 0, 30, 60, 90, 120, 150, 180, 210, 240, 225, 195}) {
    ASSERT_TRUE(sweep.next());
    EXPECT_NEAR(degrees(*sweep.next()), place, 1e-9);
    sweep.skip();
  }
}

TEST(Sweep, has_no_feature_before_it_is_asked_for_and_worked_out) {
  const Configuration c = narrow();
  Sweep sweep(c, 0);
  EXPECT_EQ(sweep.feature(), nullptr);
  sweep.conclude();
  EXPECT_EQ(sweep.feature(), nullptr);
  while (sweep.step()) {
  }
  ASSERT_NE(sweep.feature(), nullptr);
  EXPECT_FALSE(*sweep.feature()) << "of no point";
  EXPECT_FALSE(sweep.axis_sigma_rad());
}

}  // namespace
}  // namespace armsig::controller
