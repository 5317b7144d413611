// SPDX-License-Identifier: MIT
// The point that spheres meet in, before anybody asks which side it is on.
#include <random>

#include <gtest/gtest.h>

#include "core/measurement/range_fit.hpp"

namespace armsig::measurement {
namespace {

double uniform(std::mt19937_64& random, double lower, double upper) {
  return std::uniform_real_distribution(lower, upper)(random);
}

// Four receivers in a plane, long and narrow: the search begins at the solution, and need not find
// its way along the valleys between it and other points.
TEST(FitPoint, of_exact_ranges_to_a_narrow_array_is_the_target) {
  constexpr double kSigma = 1e-6;
  std::mt19937_64 random(5);
  for (int k = 0; k < 500; ++k) {
    const Vector3 target(uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0.2, 2));
    Spheres spheres;
    for (int i = 0; i < 4; ++i) {
      const Vector3 centre(uniform(random, -1, 1), uniform(random, -0.3, 0.3), 0);
      spheres.push_back({centre, (target - centre).norm(), kSigma});
    }
    bool found = false;
    for (const PointFit& fit : fit_point(spheres))
      found = found || (fit.determined && (fit.p_S - target).norm() < kSigma);
    EXPECT_TRUE(found) << target.transpose();
  }
}

// A range to the receiver that the search stands on has no direction: it says how far it is off.
TEST(FitPoint, begins_on_a_receiver_and_leaves_it) {
  const std::array<Vector3, 3> centres{Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0)};
  Spheres spheres;
  for (const Vector3& centre : centres) spheres.push_back({centre, centre.norm(), 1e-4});
  bool found = false;
  for (const PointFit& fit : fit_point(spheres)) found = found || fit.p_S.norm() < 1e-3;
  EXPECT_TRUE(found);
}

Spheres exact_ranges(const std::array<Vector3, 4>& centres, const Vector3& target) {
  Spheres spheres;
  for (const Vector3& centre : centres) spheres.push_back({centre, (target - centre).norm(), 1e-5});
  return spheres;
}

// Both searches end in the target, the slower one in its fiftieth step: they found one point.
TEST(FitPoint, is_found_by_a_search_of_fifty_steps) {
  const auto fits =
      fit_point(exact_ranges({Vector3(-0.03, -0.02, 0.21), Vector3(-0.22, -0.07, -0.12),
                              Vector3(0.9, -0.1, -0.28), Vector3(0.77, 0.12, 0.05)},
                             Vector3(0.99, 1.81, 1.05)));
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_TRUE(fits[0].determined);
}

// Here the slower one would need a step more: it is given up on, and what it says is told apart.
TEST(FitPoint, is_given_up_on_after_fifty_steps) {
  const auto fits =
      fit_point(exact_ranges({Vector3(0.42, 0.02, -0.02), Vector3(-0.31, -0.02, -0.01),
                              Vector3(-0.41, 0.01, -0.06), Vector3(-0.16, 0.04, 0.05)},
                             Vector3(-0.75, -0.22, 1.44)));
  ASSERT_EQ(fits.size(), 2U);
  EXPECT_NE(fits[0].determined, fits[1].determined);
}

// What is left when others are set aside may stand on a line: the point then turns about it.
TEST(FitPoint, of_receivers_on_a_line_is_not_determined) {
  const Vector3 target(0.3, 0.4, 1);
  Spheres spheres;
  for (const double x : {-1.0, 0.0, 1.0}) {
    const Vector3 centre(x, 0, 0);
    spheres.push_back({centre, (target - centre).norm(), 1e-4});
  }
  for (const PointFit& fit : fit_point(spheres)) {
    EXPECT_FALSE(fit.determined);
    EXPECT_TRUE(fit.p_S.allFinite());
  }
}

}  // namespace
}  // namespace armsig::measurement
