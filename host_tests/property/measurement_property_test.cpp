// SPDX-License-Identifier: MIT
// The demonstration's sensor over the work volume of a Puma 560, through the whole of
// core/measurement: is the error as small as promised, the covariance true, the detour found?
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/measurement/ping_median.hpp"
#include "core/measurement/speed_of_sound.hpp"
#include "core/measurement/trilateration.hpp"
#include "hal/simulated/arm.hpp"
#include "hal/simulated/demo_sensor.hpp"

namespace armsig {
namespace {

using measurement::Position;
using measurement::Ranges;
using measurement::ReceiverArray;

// Table 1 of the paper with a target on the hand, limits of the Mark II.
simulated::SimulatedArm puma() {
  simulated::SimulatedArm puma;
  puma.arm.joints = {{JointType::kRevolute, 0, 0, 0, radians(-90)},
                     {JointType::kRevolute, 0, 0.14909, 0.4318, 0},
                     {JointType::kRevolute, 0, 0, -0.02032, radians(90)},
                     {JointType::kRevolute, 0, 0.4307, 0, radians(-90)},
                     {JointType::kRevolute, 0, 0, 0, radians(90)},
                     {JointType::kRevolute, 0, 0, 0, 0}};
  for (const auto& [lower, upper] :
       {std::pair{-160, 160}, {-225, 45}, {-45, 225}, {-110, 170}, {-100, 100}, {-266, 266}})
    puma.arm.limits.push_back({radians(lower), radians(upper)});
  puma.X_S0 = simulated::demo_base_pose();
  puma.targets = {{.number = 1, .link = 6, .p_L = {0.1, 0, 0.15}}};
  return puma;
}

Vector3 random_target(const simulated::SimulatedArm& arm, simulated::Random& random) {
  JointVector readings;
  for (const JointLimits& limits : arm.arm.limits)
    readings.push_back(random.uniform(limits.lower, limits.upper));
  return simulated::target_position(arm, readings, arm.targets[0]);
}

ReceiverArray demo_array(std::size_t receivers = 8) {
  const simulated::UltrasonicConfig config = simulated::demo_sensor();
  ReceiverArray array{.p_S = config.receivers_S,
                      .range_sigma_m = config.range_sigma_m,
                      .facing_S = simulated::demo_sensor_facing()};
  array.p_S.resize(receivers, Vector3::Zero());
  return array;
}

Ranges ranges_of(const simulated::Sounding& sounding) {
  FlightTimes flights;
  for (std::size_t j = 0; j < sounding.time_ns.size(); ++j)
    flights.push_back({.seconds = 1e-9 * sounding.time_ns[j], .valid = sounding.valid[j]});
  return measurement::ranges_from_times(flights, *measurement::speed_of_sound(sounding.air_celsius),
                                        measurement::SoundPath::kOneWay);
}

double normalised_error_squared(const Position& position, const Vector3& truth) {
  const Vector3 error = position.p_S - truth;
  return error.dot(position.covariance_m2.inverse() * error);
}

TEST(DemoSensor, passes_the_check_and_stands_clear_of_the_arm) {
  EXPECT_TRUE(measurement::check(demo_array()));
  for (const Vector3& p_S : demo_array().p_S)
    EXPECT_GT((p_S - simulated::demo_base_pose().p).norm(), 1.06 + 0.5);
}

TEST(DemoSensor, error_per_axis_is_an_eighth_to_a_fifth_of_a_millimetre_everywhere) {
  const auto arm = puma();
  const ReceiverArray array = demo_array();
  simulated::Random random(1);
  double best = 1;
  double worst = 0;
  double worst_axis = 0;
  double mean_square = 0;
  constexpr int kTargets = 2000;
  for (int i = 0; i < kTargets; ++i) {
    const Vector3 target = random_target(arm, random);
    Ranges ranges;
    for (const Vector3& receiver : array.p_S)
      ranges.push_back({.metres = (target - receiver).norm(), .valid = true});
    const auto position = measurement::trilaterate(array, ranges);
    ASSERT_TRUE(position);
    ASSERT_LT((position->p_S - target).norm(), 1e-12);
    const double variance = position->covariance_m2.trace() / 3;
    best = std::min(best, std::sqrt(variance));
    worst = std::max(worst, std::sqrt(variance));
    worst_axis = std::max(worst_axis, std::sqrt(position->covariance_m2.diagonal().maxCoeff()));
    mean_square += variance / kTargets;
  }
  RecordProperty("best_um", static_cast<int>(1e6 * best));
  RecordProperty("worst_um", static_cast<int>(1e6 * worst));
  EXPECT_GT(best, 0.12e-3);
  EXPECT_LT(worst, 0.205e-3);
  EXPECT_LT(worst_axis, 0.245e-3);
  EXPECT_NEAR(std::sqrt(mean_square), 0.153e-3, 0.005e-3);
}

// Sum of the normalised error squared over n trials of three axes: chi-square with 3n degrees of
// freedom, whose 95 % interval is 3n +- 1.96 sqrt(6n). Four receivers of the lower square leave one
// redundant range, three none: mirror images are decided by facing_S.
TEST(Trilateration, covariance_is_true_for_any_number_of_receivers) {
  const auto arm = puma();
  constexpr int kTrials = 2000;
  for (std::size_t receivers = 3; receivers <= 8; ++receivers) {
    simulated::UltrasonicField field(simulated::demo_sensor(), simulated::Random(20, receivers));
    const ReceiverArray array = demo_array(receivers);
    simulated::Random random(21);
    double sum = 0;
    int solved = 0;
    for (int i = 0; i < kTrials; ++i) {
      const Vector3 target = random_target(arm, random);
      Ranges ranges = ranges_of(field.measure(target));
      ranges.resize(receivers);
      const auto position = measurement::trilaterate(array, ranges);
      if (!position) continue;
      ++solved;
      sum += normalised_error_squared(*position, target);
    }
    EXPECT_GE(solved, 0.998 * kTrials) << receivers << " receivers";
    EXPECT_NEAR(sum / solved, 3, 1.96 * std::sqrt(6.0 / solved)) << receivers << " receivers";
  }
}

TEST(Trilateration, covariance_is_true_next_to_the_plane_of_a_flat_array_or_refused) {
  simulated::UltrasonicConfig config = simulated::demo_sensor();
  config.receivers_S.resize(4, Vector3::Zero());
  simulated::UltrasonicField field(config, simulated::Random(25));
  const ReceiverArray array = demo_array(4);
  simulated::Random random(26);
  double sum = 0;
  int solved = 0;
  int refused = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3 target(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.1, 0));
    const auto position = measurement::trilaterate(array, ranges_of(field.measure(target)));
    if (position) {
      ++solved;
      sum += normalised_error_squared(*position, target);
    } else if (position.error() == Error::kSingular) {
      ++refused;
    }
  }
  EXPECT_GT(solved, 2000);
  EXPECT_GT(refused, 500);
  EXPECT_GE(solved + refused, 3990);
  EXPECT_NEAR(sum / solved, 3, 0.15);
}

TEST(Trilateration, covariance_of_medians_of_pings_is_true) {
  const auto arm = puma();
  simulated::UltrasonicField field(simulated::demo_sensor(), simulated::Random(30));
  const ReceiverArray array = demo_array();
  simulated::Random random(31);
  constexpr int kTrials = 2000;
  double sum = 0;
  for (int i = 0; i < kTrials; ++i) {
    const Vector3 target = random_target(arm, random);
    measurement::PingMedian dwell(array.p_S.size());
    for (int ping = 0; ping < 5; ++ping) ASSERT_TRUE(dwell.add(ranges_of(field.measure(target))));
    const auto position = measurement::trilaterate(array, dwell.median());
    ASSERT_TRUE(position);
    sum += normalised_error_squared(*position, target);
  }
  EXPECT_NEAR(sum / kTrials, 3, 1.96 * std::sqrt(6.0 / kTrials));
}

struct MultipathCount {
  int solved = 0;
  int wrong = 0;             // solved, but off by more than five sigma
  int exactly_one = 0;       // trials with exactly one detour
  int named = 0;             // of those: excluded exactly that one
  double error_squared = 0;  // normalised, sum over those solved and not wrong
};

constexpr int kMultipathTrials = 2000;

// Every range takes a detour with a probability of 20 %. Receivers alternately from the lower and
// the upper square of the demonstration's frame.
MultipathCount with_multipath(std::size_t receivers) {
  simulated::UltrasonicConfig config = simulated::demo_sensor();
  const auto all = config.receivers_S;
  config.multipath_probability = 0.2;
  config.receivers_S.clear();
  for (const std::size_t j : {0U, 6U, 1U, 7U, 2U, 4U, 3U, 5U})
    if (config.receivers_S.size() < receivers) config.receivers_S.push_back(all[j]);
  ReceiverArray array = demo_array();
  array.p_S = config.receivers_S;

  simulated::UltrasonicField field(config, simulated::Random(40, receivers));
  const auto arm = puma();
  simulated::Random random(41);
  MultipathCount count;
  for (int i = 0; i < kMultipathTrials; ++i) {
    const Vector3 target = random_target(arm, random);
    const simulated::Sounding sounding = field.measure(target);
    const auto position = measurement::trilaterate(array, ranges_of(sounding));
    const bool one = std::count(sounding.multipath.begin(), sounding.multipath.end(), true) == 1;
    if (one) ++count.exactly_one;
    if (!position) continue;
    ++count.solved;
    if (one && position->excluded.size() == 1 && sounding.multipath[position->excluded[0]])
      ++count.named;
    const double error_squared = normalised_error_squared(*position, target);
    if (error_squared > 25)
      ++count.wrong;
    else
      count.error_squared += error_squared;
  }
  return count;
}

TEST(Trilateration, names_a_single_detour_among_five_or_more_receivers) {
  for (std::size_t receivers = 5; receivers <= 8; ++receivers) {
    const MultipathCount count = with_multipath(receivers);
    EXPECT_GT(count.exactly_one, 500);
    EXPECT_GE(count.named, 0.98 * count.exactly_one) << receivers << " receivers";
  }
}

TEST(Trilateration, detours_hardly_ever_go_unnoticed) {
  // Of four receivers: two or more detours that happen to agree. Five receivers that two detours
  // leave three good ranges of are the worst case after that.
  EXPECT_LE(with_multipath(4).wrong, 0.01 * kMultipathTrials);
  EXPECT_LE(with_multipath(5).wrong, 0.006 * kMultipathTrials);
  EXPECT_LE(with_multipath(6).wrong, 0.002 * kMultipathTrials);
  EXPECT_LE(with_multipath(8).wrong, 0.001 * kMultipathTrials);
}

TEST(Trilateration, eight_receivers_with_a_fifth_of_detours_still_locate_nine_targets_in_ten) {
  const MultipathCount count = with_multipath(8);
  EXPECT_GE(count.solved, 0.92 * kMultipathTrials);
  EXPECT_NEAR(count.error_squared / (count.solved - count.wrong), 3, 0.15);
}

}  // namespace
}  // namespace armsig
