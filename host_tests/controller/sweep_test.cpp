// SPDX-License-Identifier: MIT
// Where the points of a sweep are.
#include "firmware/controller/sweep.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"
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

// How many points a sweep of joint 1 takes, each off its circle by `noise_m` to one side or the
// other.
std::size_t points_of(const Configuration& configuration, double noise_m) {
  Sweep sweep(configuration, 0);
  for (int k = 0; k < 20; ++k) {
    const double q = *sweep.next();
    const double r = 0.8 + (k % 2 == 0 ? noise_m : -noise_m);
    EXPECT_TRUE(sweep.add(q, {r * std::cos(q), r * std::sin(q), 0.3 + (k % 3 - 1) * noise_m},
                          noise_m * noise_m * Matrix3::Identity()));
    while (sweep.step()) {
    }
    if (!sweep.next()) break;
  }
  return sweep.done();
}

// Only as far as axis and centre ask; each of them keeps it going.
TEST(Sweep, goes_on_until_axis_and_centre_are_known_well_enough) {
  Configuration c = test::puma_controller();
  c.sweeps.points = 8;
  c.sweeps.most_points = 20;
  c.sweeps.axis_sigma_rad = c.sweeps.point_sigma_m = 1e-2;
  EXPECT_EQ(points_of(c, 1e-3), 4U);
  c.sweeps.point_sigma_m = 1e-6;
  EXPECT_EQ(points_of(c, 1e-3), 20U);
  c.sweeps.point_sigma_m = 1e-2;
  c.sweeps.axis_sigma_rad = 1e-6;
  EXPECT_EQ(points_of(c, 1e-3), 20U);
}

TEST(Sweep, takes_no_point_that_is_no_number) {
  const Configuration c = test::puma_controller();
  Sweep sweep(c, 0);
  const auto added = sweep.add(0.1, {0.5, test::kNan, 0.3}, 1e-8 * Matrix3::Identity());
  EXPECT_EQ(test::failure_of(added), Error::kNotFinite);
}

}  // namespace
}  // namespace armsig::controller
