// SPDX-License-Identifier: MIT
#include <cmath>

#include <gtest/gtest.h>

#include "hal/simulated/random.hpp"

namespace armsig::simulated {
namespace {

// Golden values: splitmix64 and xoshiro256** in Python integers.
TEST(Random, bits_are_those_of_the_published_generator) {
  Random random(42);
  EXPECT_EQ(random.bits(), 1546998764402558742U);
  EXPECT_EQ(random.bits(), 6990951692964543102U);
  EXPECT_EQ(random.bits(), 12544586762248559009U);
  EXPECT_EQ(random.bits(), 17057574109182124193U);
}

// Golden values: the polar method in Python on the same bits.
TEST(Random, normals_are_those_of_the_polar_method) {
  Random random(42);
  EXPECT_NEAR(random.normal(), -0.7262191382447857, 1e-15);
  EXPECT_NEAR(random.normal(), -0.21119691823195985, 1e-15);
  EXPECT_NEAR(random.normal(), 0.2216227015035933, 1e-15);
  EXPECT_NEAR(random.normal(), 0.5227716877560146, 1e-15);
}

TEST(Random, same_seed_and_stream_repeat) {
  Random a(7, 3);
  Random b(7, 3);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.normal(), b.normal());
}

TEST(Random, streams_and_seeds_differ) {
  EXPECT_NE(Random(7, 3).bits(), Random(7, 4).bits());
  EXPECT_NE(Random(7, 3).bits(), Random(8, 3).bits());
  EXPECT_NE(Random(1, 2).bits(), Random(2, 1).bits());
}

TEST(Random, streams_of_a_seed_are_uncorrelated) {
  constexpr int kCount = 100'000;
  Random a(11, 1);
  Random b(11, 2);
  double sum = 0;
  for (int i = 0; i < kCount; ++i) sum += a.normal() * b.normal();
  EXPECT_LT(std::abs(sum / kCount), 5 / std::sqrt(kCount));
}

TEST(Random, uniform_stays_in_its_interval_and_fills_it) {
  Random random(1);
  double lowest = 1;
  double highest = 0;
  for (int i = 0; i < 10'000; ++i) {
    const double u = random.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    lowest = std::min(lowest, u);
    highest = std::max(highest, u);
  }
  EXPECT_LT(lowest, 0.002);
  EXPECT_GT(highest, 0.998);
}

TEST(Random, normal_has_the_moments_of_a_normal) {
  constexpr int kCount = 200'000;
  Random random(5);
  double first = 0;
  double second = 0;
  double fourth = 0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    first += x / kCount;
    second += x * x / kCount;
    fourth += x * x * x * x / kCount;
  }
  // Five standard errors: 1, sqrt(2), sqrt(96) over sqrt(count).
  EXPECT_NEAR(first, 0, 0.012);
  EXPECT_NEAR(second, 1, 0.016);
  EXPECT_NEAR(fourth, 3, 0.11);
}

TEST(Random, direction_is_a_unit_vector_without_preference) {
  constexpr int kCount = 50'000;
  Random random(6);
  Vector3 mean = Vector3::Zero();
  for (int i = 0; i < kCount; ++i) {
    const Vector3 u = random.direction();
    ASSERT_NEAR(u.norm(), 1, 1e-15);
    mean += u / kCount;
  }
  EXPECT_LT(mean.norm(), 0.02);
}

TEST(PortableLog, agrees_with_the_library) {
  for (int i = -4000; i <= 4000; ++i) {
    const double x = std::pow(1.19, i);
    const double expected = std::log(x);
    EXPECT_NEAR(portable_log(x), expected, 4e-16 * (1 + std::abs(expected))) << x;
  }
  EXPECT_EQ(portable_log(1), 0);
}

}  // namespace
}  // namespace armsig::simulated
