// SPDX-License-Identifier: MIT
// Two signatures as their documents say them, held against each other joint by joint.
#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/base/pose.hpp"
#include "firmware/fleet/host/signature_comparison.hpp"

namespace armsig::fleet {
namespace {

// A PUMA 560 as the controller tells it, with one value changed.
std::string puma(const std::string& key = "", double value = 0) {
  const std::array<std::array<double, 4>, 6> rows{{{0, 0, 0, -90},
                                                   {0, 149.09, 431.8, 0},
                                                   {90, 0, -20.32, 90},
                                                   {0, 433.07, 0, -90},
                                                   {0, 0, 0, 90},
                                                   {0, 56.25, 0, 0}}};
  const std::array<std::pair<std::string, std::string>, 4> names{
      {{"theta", "_deg"}, {"d", "_mm"}, {"a", "_mm"}, {"alpha", "_deg"}}};
  std::string document;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string name = names[k].first + std::to_string(i + 1) + names[k].second;
      if (!document.empty()) document += ' ';
      document += name + '=' + std::to_string(name == key ? value : rows[i][k]);
    }
  }
  return document;
}

TEST(FleetComparison, SameSignaturesDifferByNothing) {
  const auto compared = compare_signatures(puma(), puma());
  ASSERT_TRUE(compared);
  ASSERT_EQ(compared->joints.size(), 6U);
  EXPECT_LT(compared->tool_rms_m, 1e-9);
}

// A row's a, alpha and theta move the next axis, the next axis, and the joint's own zero.
TEST(FleetComparison, ChangeIsToldAtTheJointWhereItIs) {
  auto compared = compare_signatures(puma(), puma("a2_mm", 432.8));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].shift_m, i == 2 ? 1e-3 : 0, 1e-7) << i;
    EXPECT_NEAR(compared->joints[i].tilt_rad, 0, 1e-7) << i;
  }
  EXPECT_GT(compared->tool_rms_m, 1e-4);
  compared = compare_signatures(puma(), puma("alpha3_deg", 90.05));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].tilt_rad, i == 3 ? radians(0.05) : 0, 1e-6) << i;
  }
  compared = compare_signatures(puma(), puma("theta5_deg", 0.1));
  ASSERT_TRUE(compared);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(compared->joints[i].zero_rad, i == 4 ? radians(0.1) : 0, 1e-6) << i;
  }
}

// Rows near parallel axes are metres apart for a microradian; the axes are not.
TEST(FleetComparison, NearlyParallelAxesAreComparedAsLines) {
  const auto compared = compare_signatures(puma(), puma("alpha2_deg", 0.001));
  ASSERT_TRUE(compared);
  EXPECT_NEAR(compared->joints[2].tilt_rad, radians(0.001), 1e-7);
  EXPECT_LT(compared->joints[2].shift_m, 1e-6);
}

TEST(FleetComparison, NothingThatAnArmSaysIsTooMuch) {
  for (const char* document :
       {"", "theta1_deg", "theta1_deg=", "theta1_deg=nan d1_mm=0 a1_mm=0 alpha1_deg=0",
        "theta1_deg=1 d1_mm=1 a1_mm=1", "theta2_deg=1 d2_mm=1 a2_mm=1 alpha2_deg=1",
        "theta1_deg=1,d1_mm=1 a1_mm=1 alpha1_deg=1"}) {
    EXPECT_FALSE(arm_of_document(document)) << document;
    EXPECT_FALSE(compare_signatures(puma(), document)) << document;
  }
  for (const std::string key : {"theta3_deg", "d3_mm", "a3_mm", "alpha3_deg"}) {
    for (const double value : {1e8, -9e8, 1e-300, 180.0, 90.0}) {
      EXPECT_TRUE(arm_of_document(puma(key, value)));
      (void)compare_signatures(puma(), puma(key, value));
      (void)compare_signatures(puma(key, value), puma());
    }
  }
  const std::string one = "theta1_deg=0 d1_mm=0 a1_mm=0 alpha1_deg=0";
  ASSERT_TRUE(arm_of_document(one));
  (void)compare_signatures(one, one);
}

}  // namespace
}  // namespace armsig::fleet
