// SPDX-License-Identifier: MIT
// A fleet of simulated arms under daily and weekly checks: a link that drifts by 0.1 mm is named
// within ten checks in 99 of 100, and at most one healthy arm in a thousand arm-months. The world
// is simulated here, by nothing of what computes the threshold.
#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/drift/cusum.hpp"
#include "host_tests/support/simulated_checks.hpp"

namespace armsig::drift {
namespace {

using test::settings_for;
using test::SimulatedArm;

void expect_the_figures(double checks_per_month) {
  const Settings settings = settings_for(checks_per_month);
  const int year = static_cast<int>(12 * checks_per_month);
  simulated::Random random(2026);
  constexpr int kArms = 10'000;
  int false_alarms = 0;
  int named = 0;
  for (int arm = 0; arm < kArms; ++arm) {
    SimulatedArm simulated(random);
    State state;
    for (int i = 0; i < year && !state.named; ++i) {
      state = after_check(state, simulated.check(), settings).value_or(state);
    }
    ASSERT_GE(state.checks, 1);
    false_alarms += state.named ? 1 : 0;
    SimulatedArm drifted(random);
    const Vector3 drift = 0.1e-3 * random.direction();
    State after;
    for (int i = 0; i < 10; ++i) {
      after = after_check(after, drifted.check() + drift, settings).value_or(after);
    }
    ASSERT_EQ(after.checks, 10);
    named += after.named ? 1 : 0;
  }
  const double per_thousand_months = 1e3 * false_alarms / (12.0 * kArms);
  testing::Test::RecordProperty("threshold", std::to_string(settings.threshold));
  testing::Test::RecordProperty("false_alarms_per_1000_arm_months",
                                std::to_string(per_thousand_months));
  testing::Test::RecordProperty("named_within_10",
                                std::to_string(static_cast<double>(named) / kArms));
  EXPECT_LE(per_thousand_months, 1.0);
  EXPECT_GE(named, kArms * 99 / 100);
}

TEST(DriftProperty, DailyChecksNameADriftAndRarelyAHealthyArm) { expect_the_figures(365.25 / 12); }

TEST(DriftProperty, WeeklyChecksNameADriftAndRarelyAHealthyArm) { expect_the_figures(365.25 / 84); }

// Every arm at the largest noise, as the threshold expects it: nothing in hand.
TEST(DriftProperty, StatedRateOfFalseAlarmsIsTheOneThatComes) {
  const Settings settings = settings_for(365.25 / 12);
  simulated::Random random(5);
  constexpr int kArms = 20'000;
  int false_alarms = 0;
  for (int arm = 0; arm < kArms; ++arm) {
    Vector3 noise = random.normal_vector();
    Vector3 reference = Vector3::Zero();
    Vector3 sum = Vector3::Zero();
    bool alarm = false;
    for (int i = -20; i < 365 && !alarm; ++i) {
      if (i < 0) reference += noise / 20;
      if (i >= 0) sum = crosier(sum, 1.1 * (noise - reference), settings.reference);
      alarm = sum.norm() > settings.threshold;
      noise = 0.3 * noise + std::sqrt(1 - 0.09) * random.normal_vector();
    }
    false_alarms += alarm ? 1 : 0;
  }
  EXPECT_NEAR(1e3 * false_alarms / (12.0 * kArms), 1.0, 0.25);
}

}  // namespace
}  // namespace armsig::drift
