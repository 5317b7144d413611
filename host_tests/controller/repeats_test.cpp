// SPDX-License-Identifier: MIT
// Whether something changed, from poses that were measured twice.
#include "firmware/self_calibration/repeats.hpp"

#include <gtest/gtest.h>

#include "hal/simulated/random.hpp"

namespace armsig::controller {
namespace {

constexpr double kRepeatSigma_m = 0.1e-3;

struct Shown {
  Vector3 in_hand = Vector3::Zero();
  Vector3 in_sensor = Vector3::Zero();
  double of_pose = 0;    // in another direction at each
  double load = 0;       // of two joints, by this much and half as much the other way
  int wrong_points = 0;  // by 20 mm
};

Repeats::Change seen(const Shown& shown, std::uint64_t seed) {
  simulated::Random random(seed);
  simulated::Random levers(seed, 2);
  Repeats repeats;
  for (int n = 0; n < static_cast<int>(Repeats::kMost); ++n) {
    const Matrix3 R_SL = rotation_about(random.normal_vector().normalized(), random.uniform(-3, 3));
    Vector3 difference = R_SL * shown.in_hand + shown.in_sensor;
    difference += shown.of_pose * random.normal_vector().normalized();
    const Repeats::Motions by_load{levers.uniform(0, 1) * levers.normal_vector(),
                                   levers.uniform(0, 1) * levers.normal_vector()};
    difference += shown.load * (by_load[0] - by_load[1] / 2);
    if (n < shown.wrong_points) difference += 20e-3 * random.normal_vector().normalized();
    difference += kRepeatSigma_m * random.normal_vector();
    repeats.add(R_SL, difference, kRepeatSigma_m * kRepeatSigma_m, by_load);
  }
  return repeats.change(shown.wrong_points / 20.0, 0.075e-3);
}

TEST(Repeats, say_nothing_of_chance_and_of_single_wrong_points) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    EXPECT_EQ(seen({}, seed).what, "");
    EXPECT_EQ(seen({.wrong_points = 3}, seed).what, "") << seed;
  }
}

TEST(Repeats, tell_the_target_from_the_sensor_and_the_arm) {
  const Vector3 half_mm(0.3e-3, -0.3e-3, 0.25e-3);
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto slipped = seen({.in_hand = half_mm, .wrong_points = 2}, seed);
    EXPECT_EQ(slipped.what, "target") << seed;
    EXPECT_NEAR(slipped.by_m, half_mm.norm(), 0.25e-3);
    EXPECT_EQ(seen({.in_sensor = half_mm, .wrong_points = 2}, seed).what, "sensor") << seed;
    const auto bent = seen({.of_pose = 1e-3, .wrong_points = 2}, seed);
    EXPECT_EQ(bent.what, "arm") << seed;
    EXPECT_NEAR(bent.by_m, 1e-3, 0.3e-3);
  }
}

TEST(Repeats, name_a_load_that_bends_the_joints_where_few_poses_show_it_singly) {
  int seen_ones = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const auto loaded = seen({.load = 0.4e-3, .wrong_points = 2}, seed);
    seen_ones += loaded.what == "load" && std::abs(loaded.by_m - 0.45e-3) < 0.25e-3;
    EXPECT_EQ(seen({.load = 1.5e-3, .wrong_points = 3}, seed).what, "load") << seed;
  }
  EXPECT_GE(seen_ones, 90);
}

// A joint that no weight turns at any of the poses.
TEST(Repeats, name_a_load_beside_a_joint_that_it_does_not_turn) {
  Repeats repeats;
  for (std::size_t n = 0; n < Repeats::kMost; ++n) {
    const Vector3 down(0, 0, -0.2 - 0.05 * static_cast<double>(n));
    repeats.add(Matrix3::Identity(), 1e-3 * down, kRepeatSigma_m * kRepeatSigma_m,
                {Vector3::Zero(), down});
  }
  EXPECT_EQ(repeats.change(0, 0.075e-3).what, "load");
}

TEST(Repeats, see_a_common_shift_that_no_single_pose_shows) {
  int seen_ones = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    seen_ones += seen({.in_hand = Vector3(0.28e-3, 0, 0)}, seed).what == "target";
  }
  EXPECT_GE(seen_ones, 80);
}

TEST(Repeats, see_what_only_a_few_poses_show_where_no_point_is_wrong) {
  Repeats repeats;
  for (std::size_t n = 0; n < Repeats::kMost; ++n) {
    const Vector3 sag(0, 0, n % 6 == 0 ? -1e-3 : 0);
    repeats.add(Matrix3::Identity(), sag, kRepeatSigma_m * kRepeatSigma_m);
  }
  EXPECT_EQ(repeats.change(0, 0.075e-3).what, "arm");
  EXPECT_NEAR(repeats.change(0, 0.075e-3).by_m, 1e-3, 1e-9);
  EXPECT_EQ(repeats.change(0.1, 0.075e-3).what, "") << "wrong points would do as much";
}

TEST(Repeats, leave_alone_what_does_not_matter_for_the_accuracy_asked_for) {
  Repeats repeats;
  EXPECT_EQ(repeats.change(0, 0).what, "") << "nothing was measured again";
  for (std::size_t n = 0; n < Repeats::kMost; ++n) {
    repeats.add(Matrix3::Identity(), Vector3(0.05e-3, 0, 0), 1e-12);
  }
  EXPECT_EQ(repeats.change(0, 0.06e-3).what, "");
  EXPECT_NE(repeats.change(0, 0.04e-3).what, "");
}

}  // namespace
}  // namespace armsig::controller
