// SPDX-License-Identifier: MIT
#include "core/base/sine_cosine.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"

namespace armsig {
namespace {

struct Worst {
  long double sine = 0;
  long double cosine = 0;

  void add(double angle) {
    Pack<double> s;
    Pack<double> c;
    sine_cosine(Pack<double>{} + angle, s, c);
    add(angle, s[0], c[0]);
    const auto [sine_alone, cosine_alone] = sine_and_cosine(angle);
    add(angle, sine_alone, cosine_alone);
  }
  template <typename Scalar>
  void add(Scalar angle, Scalar s, Scalar c) {
    const auto exact = static_cast<long double>(angle);
    sine = std::max(sine, std::abs(static_cast<long double>(s) - std::sin(exact)));
    cosine = std::max(cosine, std::abs(static_cast<long double>(c) - std::cos(exact)));
  }
};

constexpr long double kBoundDouble = 5.1e-16L;
constexpr long double kBoundSingle = 0x1p-22L;

TEST(SineCosine, keeps_its_bound_over_a_dense_turn) {
  Worst worst;
  for (int k = -400000; k <= 400000; ++k) worst.add(k * (kPi / 400000));
  EXPECT_LT(worst.sine, kBoundDouble);
  EXPECT_LT(worst.cosine, kBoundDouble);
}

TEST(SineCosine, keeps_its_bound_up_to_its_largest_angle) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution angle(-SineCosineConstants<double>::kLargestAngle,
                                       SineCosineConstants<double>::kLargestAngle);
  Worst worst;
  for (int k = 0; k < 400000; ++k) worst.add(angle(random));
  EXPECT_LT(worst.sine, kBoundDouble);
  EXPECT_LT(worst.cosine, kBoundDouble);
}

TEST(SineCosine, keeps_its_bound_beside_every_quarter_turn) {
  Worst worst;
  for (int k = -40000; k <= 40000; ++k) {
    const double quarter = k * (kPi / 2);
    for (const double angle : {quarter, std::nextafter(quarter, 1e9), std::nextafter(quarter, -1e9),
                               quarter + 1e-9, quarter - 1e-9}) {
      worst.add(angle);
    }
  }
  EXPECT_LT(worst.sine, kBoundDouble);
  EXPECT_LT(worst.cosine, kBoundDouble);
}

TEST(SineCosine, keeps_its_bound_in_single_precision) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution angle(-SineCosineConstants<float>::kLargestAngle,
                                       SineCosineConstants<float>::kLargestAngle);
  Worst worst;
  const auto add = [&](float x) {
    const auto [s, c] = sine_and_cosine(x);
    worst.add(x, s, c);
  };
  for (int k = 0; k < 400000; ++k) add(angle(random));
  for (int k = -200000; k <= 200000; ++k) add(static_cast<float>(k * (kPi / 200000)));
  EXPECT_LT(worst.sine, kBoundSingle);
  EXPECT_LT(worst.cosine, kBoundSingle);
}

TEST(SineCosine, is_exact_at_zero) {
  Pack<double> s;
  Pack<double> c;
  sine_cosine(Pack<double>{}, s, c);
  EXPECT_EQ(s[0], 0.0);
  EXPECT_EQ(c[0], 1.0);
}

}  // namespace
}  // namespace armsig
