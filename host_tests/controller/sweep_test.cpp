// SPDX-License-Identifier: MIT
// Where the points of a sweep are.
#include "firmware/controller/sweep.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

// Readings in degrees, of joint 1 about zero, if no point can be measured.
std::vector<double> places(double arc_deg, std::size_t points, std::size_t most_points) {
  Configuration configuration = test::puma_controller();
  configuration.drawing.limits[0] = {radians(-50), radians(50)};
  configuration.sweeps.arc_rad = radians(arc_deg);
  configuration.sweeps.points = points;
  configuration.sweeps.most_points = most_points;
  Sweep sweep(configuration, 0);
  std::vector<double> places;
  for (int i = 0; i < 100; ++i) {
    const auto next = sweep.next();
    if (!next) break;
    places.push_back(std::round(1e6 * degrees(*next)) / 1e6);
    sweep.skip();
  }
  return places;
}

TEST(Sweep, goes_up_its_arc_and_on_to_both_limits) {
  EXPECT_EQ(places(40, 3, 5), (std::vector<double>{-20, 0, 20, 40, -40}));
}

TEST(Sweep, measures_between_its_places_on_the_way_back) {
  EXPECT_EQ(places(40, 3, 8), (std::vector<double>{-20, 0, 20, 40, -40, -30, -10, 10}));
  EXPECT_EQ(places(40, 3, 30), (std::vector<double>{-20, 0, 20, 40, -40, -30, -10, 10, 30}));
  EXPECT_EQ(places(120, 3, 30), (std::vector<double>{-50, 0, 50, 25, -25}));
}

}  // namespace
}  // namespace armsig::controller
