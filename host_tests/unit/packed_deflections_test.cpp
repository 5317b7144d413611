// SPDX-License-Identifier: MIT
#include "core/calibration/packed_deflections.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
namespace {

TEST(PackedDeflections, keep_the_drawn_zero_of_each_joint) {
  const Arm arm = test::make_arm({{test::kR, 0.1, 0.4, 0.3, kPi / 2},
                                  {test::kP, 0.5, 0.12, 0.05, 0},
                                  {test::kR, -0.7, 0, 0.25, 0}},
                                 {{-3, 3}, {-0.2, 0.7}, {-3, 3}});
  const PackedDeflections deflections = packed(model_of(arm, {}));
  EXPECT_EQ(deflections.drawn_zero[0], 0.1);
  EXPECT_EQ(deflections.drawn_zero[1], 0.12);  // of a slide, a length
  EXPECT_EQ(deflections.drawn_zero[2], -0.7);
}

// As a stored record may hold it.
TEST(PackedDeflections, are_checked_for_bounds_and_numbers) {
  const Arm arm = test::puma();
  ArmModel model = model_of(arm, {});
  choose_gravity_terms(arm, model);
  const PackedDeflections good = packed(model);
  ASSERT_FALSE(good.gravity.empty());
  EXPECT_TRUE(check(good, arm));
  EXPECT_TRUE(check({}, arm));
  const auto refused = [&](auto change) {
    PackedDeflections changed = good;
    change(changed);
    const auto checked = check(changed, arm);
    return !checked && checked.error() == Error::kOutOfRange;
  };
  const double nan = std::nan("");
  EXPECT_TRUE(refused([](PackedDeflections& d) { d.maps.resize(5); }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.maps[0].domain.origin = nan; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.maps[0].domain.per_length = -1; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.maps[0].domain.per_length = 2e5; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.maps[5].step = nan; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.drawn_zero[4] = nan; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.gravity[0].joint = 6; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.gravity[0].origin = 0; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.gravity[0].origin = 7; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.gravity[0].coefficient = nan; }));
  EXPECT_TRUE(refused([&](PackedDeflections& d) { d.up_0.x() = nan; }));
}

}  // namespace
}  // namespace armsig::calibration
