// SPDX-License-Identifier: MIT
#include <array>
#include <limits>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/drift/course.hpp"
#include "core/drift/cusum.hpp"
#include "core/drift/reference.hpp"
#include "firmware/analysis/evaluation/threshold.hpp"
#include "hal/simulated/random.hpp"
#include "host_tests/support/failure_of.hpp"

namespace armsig::drift {
namespace {

using test::failure_of;

constexpr double kMillimetre = 1e-3;
constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

// By numpy 1.24 from the formula of the paper, k = 1.4.
TEST(Drift, SumFollowsCrosiersFormula) {
  const std::array<Vector3, 5> z{
      {{0.5, -0.3, 0.2}, {1.2, 1.9, -0.4}, {0.1, 2.2, 0.6}, {-0.7, 1.5, 1.1}, {0.2, 0.1, -0.3}}};
  const std::array<Vector3, 5> sums{
      {{0, 0, 0},
       {0.46397863671161654, 0.7346328414600595, -0.15465954557053885},
       {0.3026471770241305, 1.574808489642026, 0.23898251205681476},
       {-0.23263041497895778, 1.8001482148012462, 0.7839080017011992},
       {-0.00933569088182422, 0.5436399253418616, 0.13844799467113486}}};
  State state;
  const Settings settings{.sigma_m = 0.035e-3, .reference = 1.4, .threshold = 1.9};
  for (std::size_t i = 0; i < z.size(); ++i) {
    const auto next = after_check(state, settings.sigma_m * z[i], settings);
    ASSERT_TRUE(next);
    state = *next;
    EXPECT_LT((state.sum - sums[i]).norm(), 1e-12) << i;
    EXPECT_EQ(state.since, static_cast<int>(i));
    EXPECT_EQ(state.named, i >= 3) << "stays named after the sum has fallen again";
  }
  EXPECT_EQ(state.checks, 5);
}

TEST(Drift, ReferenceValueIsHalfTheShift) {
  EXPECT_NEAR(check_sigma(0.1e-3, 16), 0.025e-3, 1e-18);
  EXPECT_NEAR(reference_value(0.1e-3, 0.025e-3), 2.0, 1e-12);
}

TEST(Drift, CheckThatIsNoCheckIsRefused) {
  const Settings good{.sigma_m = 1e-4, .reference = 1, .threshold = 5};
  EXPECT_EQ(failure_of(after_check({}, {0, kNever, 0}, good)), Error::kNotFinite);
  for (const Settings& bad :
       {Settings{0, 1, 5}, Settings{1e-4, -1, 5}, Settings{1e-4, 1, 0}, Settings{kNever, 1, 5}}) {
    EXPECT_EQ(failure_of(after_check({}, Vector3::Zero(), bad)), Error::kNotPositive);
  }
}

// With an exact reference and independent checks |S| is a Markov chain of one dimension, and the
// mean number of checks to a false alarm solves an integral equation; by numpy 1.24, 64 nodes of
// Gauss and Legendre. The thresholds at which 1 - exp(-checks / mean) is 0.012.
TEST(Drift, ThresholdIsThatOfTheIntegralEquation) {
  const auto daily = threshold(0.05 / 0.035, {}, {});
  ASSERT_TRUE(daily);
  EXPECT_NEAR(*daily, 4.669, 0.1);
  const auto weekly = threshold(0.05 / 0.035, {}, {.checks_per_month = 365.25 / 84});
  ASSERT_TRUE(weekly);
  EXPECT_NEAR(*weekly, 3.874, 0.1);
  const auto small = threshold(1.0, {}, {});
  ASSERT_TRUE(small);
  EXPECT_NEAR(*small, 6.831, 0.15);
}

TEST(Drift, MeasuredReferenceAndCorrelatedChecksNeedAHigherThreshold) {
  const auto perfect = threshold(2.0, {}, {});
  const auto measured = threshold(2.0, {.baseline = 20}, {});
  const auto correlated = threshold(2.0, {.baseline = 20, .correlation = 0.3}, {});
  ASSERT_TRUE(perfect && measured && correlated);
  EXPECT_GT(*measured, *perfect + 0.3);
  EXPECT_GT(*correlated, *measured + 1);
}

TEST(Drift, ThresholdOutsideWhatCanBeComputedIsRefused) {
  for (const double reference : {0.0, -1.0, kNever}) {
    EXPECT_EQ(failure_of(threshold(reference, {}, {})), Error::kOutOfRange);
  }
  for (const Scatter& bad :
       {Scatter{.baseline = -1}, Scatter{.baseline = 1'001}, Scatter{.correlation = 1},
        Scatter{.correlation = -0.1}, Scatter{.sigma_ratio = 0}, Scatter{.sigma_ratio = kNever}}) {
    EXPECT_EQ(failure_of(threshold(1, bad, {})), Error::kOutOfRange);
  }
  for (const FalseAlarms& bad :
       {FalseAlarms{.checks_per_month = 0}, FalseAlarms{.checks_per_month = 1e9},
        FalseAlarms{.per_month = 0}, FalseAlarms{.per_month = 1},
        FalseAlarms{.checks_per_month = kNever}}) {
    EXPECT_EQ(failure_of(threshold(1, {}, bad)), Error::kOutOfRange);
  }
  EXPECT_EQ(failure_of(threshold(0.01, {.correlation = 0.9}, {})), Error::kNotConverged);
  EXPECT_EQ(failure_of(detection(1, 5, 2, 0, {})), Error::kOutOfRange);
}

// What stood in the plan for sigma_c = 0.035 mm: 0.9999 within ten checks, 3.8 on average.
TEST(Drift, DetectionSaysWhatAThresholdFinds) {
  const auto found = detection(0.05 / 0.035, 5.0, 0.1 / 0.035, 10, {});
  ASSERT_TRUE(found);
  EXPECT_GE(found->within, 0.999);
  EXPECT_NEAR(found->mean_checks, 3.8, 0.1);
  const auto unmoved = detection(0.05 / 0.035, 5.0, 0, 10, {});
  ASSERT_TRUE(unmoved);
  EXPECT_LT(unmoved->within, 0.002);
}

std::vector<Vector3> checks_with(Course course, simulated::Random& random) {
  std::vector<Vector3> checks;
  for (int i = 0; i < 40; ++i) {
    const double mm = i < 20 ? 0.0 : course == Course::kStep ? 0.1 : 0.01 * (i - 19);
    checks.push_back(kMillimetre * (0.025 * random.normal_vector() + mm * Vector3{0.6, 0, 0.8}));
  }
  return checks;
}

TEST(Drift, StepAndRampAreToldApart) {
  simulated::Random random(7);
  for (const Course course : {Course::kStep, Course::kRamp}) {
    int right = 0;
    for (int run = 0; run < 200; ++run) {
      const auto report = course_of(checks_with(course, random), 0.025 * kMillimetre);
      ASSERT_TRUE(report);
      if (report->course == course) ++right;
      EXPECT_TRUE(report->course == course || report->course == Course::kUndecided) << run;
      if (course == Course::kStep) {
        EXPECT_NEAR(report->step_checks, 20, 4);
        EXPECT_NEAR(1e3 * report->step_m.z(), 0.08, 0.03);
      } else {
        EXPECT_NEAR(1e3 * report->ramp_m_per_check.z(), 0.008, 0.003);
      }
    }
    EXPECT_GE(right, 195) << describe(course);
  }
}

// By hand, in millimetres of z and with a sigma of a tenth: a step explains (sum e)^2 / m of the
// squares, a ramp (sum u e)^2 / sum u^2.
TEST(Drift, AnExactStepAndAnExactRampAreFoundWhole) {
  const auto of_z = [](std::initializer_list<double> millimetres) {
    std::vector<Vector3> checks;
    for (const double z : millimetres) checks.emplace_back(0, 0, kMillimetre * z);
    return course_of(checks, 0.1 * kMillimetre);
  };
  const auto step = of_z({0, 0, 0, 1, 1});  // 2 of it, where the best ramp explains 9 / 5
  ASSERT_TRUE(step);
  EXPECT_EQ(step->course, Course::kStep);
  EXPECT_EQ(step->step_checks, 2);
  EXPECT_NEAR(step->step_m.z(), kMillimetre, 1e-15);
  EXPECT_NEAR(step->evidence, (2 - 1.8) / 0.02, 1e-9);
  const auto ramp = of_z({0, 0, 1, 2, 3});  // 14, where the best step explains 25 / 2
  ASSERT_TRUE(ramp);
  EXPECT_EQ(ramp->course, Course::kRamp);
  EXPECT_EQ(ramp->ramp_checks, 3);
  EXPECT_NEAR(ramp->ramp_m_per_check.z(), kMillimetre, 1e-15);
  EXPECT_NEAR(ramp->evidence, (12.5 - 14) / 0.02, 1e-9);
}

TEST(Drift, FewChecksDecideNothing) {
  const std::vector<Vector3> checks{Vector3::Zero(), {1e-5, 0, 0}, {2e-5, 0, 0}};
  const auto report = course_of(checks, 0.025 * kMillimetre);
  ASSERT_TRUE(report);
  EXPECT_EQ(report->course, Course::kUndecided);
  EXPECT_EQ(failure_of(course_of({checks.data(), 2}, 1e-5)), Error::kTooFewPoints);
  EXPECT_EQ(failure_of(course_of(checks, 0)), Error::kNotPositive);
  const std::vector<Vector3> broken{Vector3::Zero(), {kNever, 0, 0}, Vector3::Zero()};
  EXPECT_EQ(failure_of(course_of(broken, 1e-5)), Error::kNotFinite);
}

// Sixteen poses about a work space of a metre; a link of 400 mm that turned on its axis, in a frame
// of its own at every pose, is what a change of the arm looks like.
std::vector<PoseResidual> sixteen_poses(Moved moved, double size_mm, simulated::Random& random) {
  const Vector3 shift{0.6 * size_mm, 0, 0.5 * size_mm};
  const Vector3 turn{0, size_mm, 0.3 * size_mm};
  std::vector<PoseResidual> poses;
  for (int i = 0; i < 16; ++i) {
    PoseResidual pose;
    pose.p_R = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(0, 0.8)};
    Vector3 mm = 0.025 * random.normal_vector();
    if (moved == Moved::kReference) mm += shift + turn.cross(pose.p_R);
    if (moved == Moved::kArm) mm += size_mm * random.direction();
    pose.residual_m = kMillimetre * mm;
    poses.push_back(pose);
  }
  return poses;
}

TEST(Drift, MovedReferenceIsToldFromAChangedArm) {
  simulated::Random random(8);
  for (const Moved moved : {Moved::kReference, Moved::kArm}) {
    int right = 0;
    for (int run = 0; run < 500; ++run) {
      const auto report = what_moved(sixteen_poses(moved, 0.15, random), 0.025 * kMillimetre);
      ASSERT_TRUE(report);
      if (report->moved == moved) ++right;
      EXPECT_TRUE(moved != Moved::kArm || report->moved != Moved::kReference) << run;
    }
    EXPECT_GE(right, 490) << describe(moved);
  }
}

TEST(Drift, WhereNothingMovedNothingIsNamed) {
  simulated::Random random(9);
  int quiet = 0;
  for (int run = 0; run < 1'000; ++run) {
    const auto report = what_moved(sixteen_poses(Moved::kNothing, 0, random), 0.025 * kMillimetre);
    ASSERT_TRUE(report);
    if (report->moved == Moved::kNothing) ++quiet;
  }
  EXPECT_GE(quiet, 990);
}

TEST(Drift, RigidMotionIsMeasured) {
  simulated::Random random(10);
  std::vector<PoseResidual> poses = sixteen_poses(Moved::kNothing, 0, random);
  const Vector3 turn{1e-4, -2e-4, 3e-4};
  Vector3 centre = Vector3::Zero();
  for (const PoseResidual& pose : poses) centre += pose.p_R / 16;
  for (PoseResidual& pose : poses) {
    pose.residual_m = Vector3{1e-4, 2e-4, 3e-4} + turn.cross(pose.p_R - centre);
  }
  const auto report = what_moved(poses, 1e-5);
  ASSERT_TRUE(report);
  EXPECT_LT((report->turn_rad - turn).norm(), 1e-12);
  EXPECT_LT((report->shift_m - Vector3{1e-4, 2e-4, 3e-4}).norm(), 1e-12);
  EXPECT_EQ(report->moved, Moved::kReference);
}

TEST(Drift, PosesThatSayNothingAreRefused) {
  std::vector<PoseResidual> line(5);
  for (std::size_t i = 0; i < line.size(); ++i) line[i].p_R = {0.1 * static_cast<double>(i), 0, 0};
  EXPECT_EQ(failure_of(what_moved(line, 1e-5)), Error::kSingular);
  EXPECT_EQ(failure_of(what_moved({line.data(), 3}, 1e-5)), Error::kTooFewPoints);
  EXPECT_EQ(failure_of(what_moved(line, 0)), Error::kNotPositive);
  line[2].residual_m.x() = kNever;
  EXPECT_EQ(failure_of(what_moved(line, 1e-5)), Error::kNotFinite);
}

TEST(Drift, WhatCannotBeDetectedIsRefused) {
  EXPECT_EQ(failure_of(detection(0, 5, 2, 10, {})), Error::kOutOfRange);
  EXPECT_EQ(failure_of(detection(1, 0, 2, 10, {})), Error::kOutOfRange);
  EXPECT_EQ(failure_of(detection(1, 5, kNever, 10, {})), Error::kOutOfRange);
  EXPECT_EQ(failure_of(detection(1, 5, 2, 1'001, {})), Error::kOutOfRange);
  EXPECT_EQ(failure_of(detection(1, 5, 2, 10, {.sigma_ratio = 11})), Error::kOutOfRange);
  const auto never = detection(1, 1e6, 0, 2, {});
  ASSERT_TRUE(never);
  EXPECT_EQ(never->within, 0);
  EXPECT_EQ(never->mean_checks, 0);
}

TEST(Drift, PosesThatAreNoNumbersAreRefused) {
  std::vector<PoseResidual> poses(4);
  poses[2].p_R.x() = kNever;
  EXPECT_EQ(failure_of(what_moved(poses, 1e-4)), Error::kNotFinite);
  poses[2].p_R.x() = 0;
  poses[3].residual_m.z() = kNever;
  EXPECT_EQ(failure_of(what_moved(poses, 1e-4)), Error::kNotFinite);
}

}  // namespace
}  // namespace armsig::drift
