// SPDX-License-Identifier: MIT
// The verdict of a check: large changes at once, small ones by the sum, and what moved.
#include "firmware/controller/check_history.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "firmware/analysis/evaluation/threshold.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::controller {
namespace {

constexpr double kSigma_m = 0.1e-3;
constexpr double kHeldOut_m = 0.2e-3;

// Checks of one arm: places all around, what the signature leaves at each of them, and noise.
class Checks {
 public:
  explicit Checks(std::uint64_t seed = 1) : random_(seed) {
    for (Vector3& p : places_) p = vector(0.5);
    for (Vector3& left : left_) left = vector(0.08e-3);
    history_.begin(1, 100);
  }

  // `change_m(place, number of the pose)` is what the arm does beside.
  template <typename F>
  Result<CheckReport> next(const F& change_m) {
    MeasuredCheck check{.poses = {}, .places = {}, .sigma_m = kSigma_m};
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const Vector3 noise_m(random_.normal(), random_.normal(), random_.normal());
      check.poses.push_back(
          {.p_R = places_[i],
           .residual_m = left_[i] + kSigma_m * noise_m + change_m(places_[i], i)});
      check.places.push_back(static_cast<std::uint8_t>(i));
    }
    return history_.take(check, kHeldOut_m);
  }
  Result<CheckReport> sound() {
    return next([](const Vector3&, std::size_t) { return Vector3(0, 0, 0); });
  }
  // Until the reference is whole.
  void learn() {
    for (int i = 0; i < kCheckBaseline; ++i) {
      const auto report = sound();
      ASSERT_TRUE(report);
      ASSERT_EQ(report->verdict, CheckVerdict::kAsAccepted);
      ASSERT_EQ(report->learnt, i + 1);
    }
  }
  CheckHistory& history() { return history_; }

 private:
  Vector3 vector(double reach) {
    return {random_.uniform(-reach, reach), random_.uniform(-reach, reach),
            random_.uniform(-reach, reach)};
  }

  simulated::Random random_;
  std::array<Vector3, kMostCheckPoses> places_;
  std::array<Vector3, kMostCheckPoses> left_;
  CheckHistory history_;
};

// A link that is longer: the tool is further out along it, wherever it points in that pose.
Vector3 longer_link(double by_m, std::size_t pose) {
  const double turn = 0.15 * static_cast<double>(pose);
  return by_m * Vector3(std::cos(turn), std::sin(turn), 0.3);
}

TEST(CheckHistory, ThresholdIsWhatCoreComputes) {
  const auto threshold = drift::threshold(
      kCheckReference, {.baseline = kCheckBaseline, .correlation = 0.3, .sigma_ratio = 1.1}, {});
  ASSERT_TRUE(threshold);
  EXPECT_NEAR(kCheckThreshold, *threshold, 0.2);
}

TEST(CheckHistory, SoundArmIsAsAcceptedForThousandChecks) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Checks checks(seed);
    for (int i = 0; i < 100; ++i) {
      const auto report = checks.sound();
      ASSERT_TRUE(report);
      ASSERT_EQ(report->verdict, CheckVerdict::kAsAccepted) << seed << " " << i;
      EXPECT_NEAR(report->sigma_m, kSigma_m / 4, 1e-12);
    }
  }
}

TEST(CheckHistory, TenthOfMillimetreIsNamedWithinTenChecksAsStep) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Checks checks(seed);
    checks.learn();
    int taken = 0;
    CheckVerdict verdict = CheckVerdict::kAsAccepted;
    while (verdict == CheckVerdict::kAsAccepted && taken < 20) {
      ++taken;
      const auto report =
          checks.next([](const Vector3&, std::size_t pose) { return longer_link(0.13e-3, pose); });
      ASSERT_TRUE(report);
      verdict = report->verdict;
    }
    EXPECT_LE(taken, 10) << seed;
    EXPECT_EQ(verdict, CheckVerdict::kStepped) << seed;
  }
}

TEST(CheckHistory, WhatGrowsByAHundredthACheckDrifts) {
  int drifting = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Checks checks(seed);
    checks.learn();
    CheckVerdict verdict = CheckVerdict::kAsAccepted;
    for (int i = 1; i <= 25; ++i) {
      const auto report = checks.next(
          [&](const Vector3&, std::size_t pose) { return longer_link(1e-5 * i, pose); });
      ASSERT_TRUE(report);
      verdict = report->verdict;
    }
    EXPECT_NE(verdict, CheckVerdict::kAsAccepted) << seed;
    if (verdict == CheckVerdict::kDrifting) ++drifting;
  }
  EXPECT_GE(drifting, 9);
}

TEST(CheckHistory, SensorThatIsPushedIsToldApartFromTheArmAtOnce) {
  const auto pushed = [](const Vector3& place, std::size_t) {
    return Vector3(Vector3(0.8e-3, -0.5e-3, 0) + Vector3(0, 1e-3, 2e-3).cross(place));
  };
  const auto bent = [](const Vector3&, std::size_t pose) { return longer_link(1e-3, 4 * pose); };
  for (const bool learnt : {false, true}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      Checks of_sensor(seed);
      Checks of_arm(seed);
      if (learnt) {
        of_sensor.learn();
        of_arm.learn();
      }
      const auto moved = of_sensor.next(pushed);
      ASSERT_TRUE(moved);
      EXPECT_EQ(moved->verdict, CheckVerdict::kReferenceMoved) << seed;
      const auto changed = of_arm.next(bent);
      ASSERT_TRUE(changed);
      EXPECT_EQ(changed->verdict, CheckVerdict::kStepped) << seed;
    }
  }
}

TEST(CheckHistory, ArmThatChangedBecomesNoReference) {
  Checks checks;
  const auto bent = [](const Vector3&, std::size_t pose) { return longer_link(1e-3, 4 * pose); };
  for (int i = 0; i < 30; ++i) {
    const auto report = checks.next(bent);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->verdict, CheckVerdict::kStepped);
    EXPECT_EQ(report->learnt, 0);
  }
}

TEST(CheckHistory, AnotherSignatureBeginsAnew) {
  Checks checks;
  checks.learn();
  checks.history().begin(1, 100);
  auto report = checks.sound();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->learnt, kCheckBaseline);
  checks.history().begin(1, 101);
  report = checks.sound();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->learnt, 1);
  checks.history().begin(2, 101);
  report = checks.sound();
  ASSERT_TRUE(report);
  EXPECT_EQ(report->learnt, 1);
}

TEST(CheckHistory, FewPosesAndNumbersThatAreNoneAreRefused) {
  Checks checks;
  MeasuredCheck few{.poses = {}, .places = {}, .sigma_m = kSigma_m};
  for (std::uint8_t i = 0; i + 1U < kFewestCheckPoses; ++i) {
    few.poses.push_back({.p_R = {0.1 * i, 0.2, 0.3 - 0.01 * i * i}, .residual_m = {0, 0, 0}});
    few.places.push_back(i);
  }
  auto report = checks.history().take(few, kHeldOut_m);
  EXPECT_EQ(test::failure_of(report), Error::kTooFewPoints);
  report = checks.next([](const Vector3&, std::size_t) {
    return Vector3::Constant(std::numeric_limits<double>::quiet_NaN()).eval();
  });
  EXPECT_EQ(test::failure_of(report), Error::kNotFinite);
}

}  // namespace
}  // namespace armsig::controller
