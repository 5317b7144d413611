// SPDX-License-Identifier: MIT
// Arms calibrated by planes, by wires and by mixtures, against the simulation.
#include <gtest/gtest.h>

#include "host_tests/places/task_of_session.hpp"

namespace armsig::tool {
namespace {

using touching::Session;
using touching::Vector3d;

TEST(Wires, find_an_arm_their_gain_and_their_zero) {
  Session session(touching::ur5(), 1);
  session.read_wire("W1", {1.2, 0, 0.1}, 1e-3, 5e-3, 80);
  session.read_wire("W2", {-0.7, 1.0, 0.2}, 1e-3, 5e-3, 80);
  session.read_wire("W3", {-0.6, -0.9, 1.3}, 1e-3, 5e-3, 80);
  const auto found = calibrated(session);
  ASSERT_TRUE(found) << render(found.error());
  const std::size_t encoder = 1;
  ASSERT_EQ(found->task->instruments[encoder].name, "encoder");
  EXPECT_NEAR(found->fit->state().scales[encoder].gain, 1e-3, 1.5e-3);
  EXPECT_NEAR(found->fit->state().scales[encoder].zero_m, 5e-3, 3e-3);
  // The gain is no better known than the nominal model's lengths: the scale is part of the error.
  EXPECT_LT(error_m(session, found->fit->state()), 2 * found->knowledge.rms_m);
  EXPECT_EQ(found->rejected.size(), 0U);
}

TEST(Planes, and_sockets_and_a_wire_are_taken_in_one_fit) {
  Session session(touching::ur5(), 2);
  session.add_bars(2, 0.3, 0.02e-3);
  session.touch_sockets(40);
  session.touch_plane("table", {0.45, 0.1, 0.1}, Vector3d(0.05, 0, 1).normalized(), 40);
  session.read_wire("W1", {1.2, 0, 0.1}, 1e-3, 5e-3, 60);
  const auto found = calibrated(session);
  ASSERT_TRUE(found) << render(found.error());
  const PlaceState& state = found->fit->state();
  EXPECT_NEAR(std::sqrt(found->fit->scales().sigma_squared[0]), 0.05e-3, 0.02e-3);
  EXPECT_NEAR(std::abs(state.places[4].point_B.z()), 1, 0.01);
  // A bar tells how long a millimetre is, and so the gain of the wire.
  EXPECT_NEAR(state.scales[2].gain, 1e-3, 0.5e-3);
  EXPECT_EQ(found->determined.geometry, 21U);
  const double error = error_m(session, state);
  EXPECT_LT(error, 0.2e-3);
  EXPECT_LT(error, 1.6 * found->knowledge.rms_m);
}

TEST(Planes, that_were_not_touched_are_named_by_the_touches_that_fit_none) {
  Session session(touching::ur5(), 3);
  session.add_bars(3, 0.3, 0.02e-3);
  session.touch_sockets(60);
  session.touch_plane("table", {0.45, 0.1, 0.1}, Vector3d::UnitZ(), 30);
  session.touch_plane("shelf", {0.45, 0.1, 0.3}, Vector3d::UnitZ(), 30);
  session.readings()[70].place = "shelf";
  const auto found = calibrated(session);
  ASSERT_TRUE(found) << render(found.error());
  ASSERT_EQ(found->rejected.size(), 1U);
  EXPECT_EQ(found->rejected[0].line, 72U);
  ASSERT_TRUE(found->rejected[0].fits);
  EXPECT_EQ(found->task->places[*found->rejected[0].fits].name, "table");
}

}  // namespace
}  // namespace armsig::tool
