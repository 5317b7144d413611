// SPDX-License-Identifier: MIT
// Every bound of the configuration from both sides: what is just within is accepted, what is just
// beyond is refused by the name of its setting, with what was found and what is needed.
#include <chrono>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/measurement_log.hpp"
#include "firmware/controller/plausibility.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"
#include "host_tests/support/whole_configuration.hpp"

namespace armsig::controller {
namespace {

using test::kNan;

hal::Duration lasting_s(double seconds) {
  return std::chrono::round<hal::Duration>(std::chrono::duration<double>(seconds));
}

struct Setting {
  const char* name;
  Bounds bounds;
  void (*set)(Configuration& c, double value);
};

const std::vector<Setting>& settings() {
  using C = Configuration;
  static const std::vector<Setting> all{
      {"limits.speed", plausible::kSpeed.revolute,
       [](C& c, double v) {
         c.limits.speed[3] = v;
         c.supervision.following_error[3] = 1;  // what it goes in two periods is no matter here
       }},
      {"limits.acceleration", plausible::kAcceleration.revolute,
       [](C& c, double v) { c.limits.acceleration[3] = v; }},
      {"limits.tool_speed", plausible::kToolSpeed, [](C& c, double v) { c.limits.tool_speed = v; }},
      {"limits.tool_turn_rate", plausible::kToolTurnRate,
       [](C& c, double v) { c.limits.tool_turn_rate = v; }},
      {"limits.least_regularity", plausible::kLeastRegularity,
       [](C& c, double v) { c.limits.least_regularity = v; }},
      {"sensor.largest_air_step", plausible::kAirStep,
       [](C& c, double v) { c.sensor.largest_air_step_kelvin = v; }},
      {"sensor.range_sigma", plausible::kRangeSigma,
       [](C& c, double v) { c.sensor.receivers.range_sigma_m = v; }},
      {"sweeps.arc", plausible::kArc, [](C& c, double v) { c.sweeps.arc_rad = v; }},
      {"sweeps.axis_sigma", plausible::kAxisSigma,
       [](C& c, double v) { c.sweeps.axis_sigma_rad = v; }},
      {"sweeps.point_sigma", plausible::kPointSigma,
       [](C& c, double v) { c.sweeps.point_sigma_m = v; }},
      {"sweeps.validation_reach", plausible::kHeldOutReach,
       [](C& c, double v) { c.sweeps.validation_reach = v; }},
      {"grid.size", plausible::kGridSize, [](C& c, double v) { c.grid.grid.size_m[2] = v; }},
  };
  return all;
}

TEST(ConfigurationBounds, are_part_of_what_is_accepted) {
  for (const Setting& setting : settings()) {
    for (const double value : {setting.bounds.lowest, setting.bounds.highest}) {
      Configuration c = test::whole_configuration();
      setting.set(c, value);
      EXPECT_TRUE(check(c)) << setting.name << " " << value;
    }
  }
}

TEST(ConfigurationBounds, are_told_with_the_value_found_where_it_is_beyond_them) {
  for (const Setting& setting : settings()) {
    for (const bool high : {false, true}) {
      const double bound = high ? setting.bounds.highest : setting.bounds.lowest;
      const double value = high ? bound * 1.001 : bound * 0.999;
      Configuration c = test::whole_configuration();
      setting.set(c, value);
      const ConfigurationRefusal refusal = test::failure_of(check(c));
      EXPECT_EQ(refusal.setting, setting.name);
      EXPECT_EQ(refusal.error, Error::kOutOfRange) << setting.name;
      EXPECT_EQ(refusal.found, value) << setting.name;
      EXPECT_EQ(refusal.needed, bound) << setting.name;
      EXPECT_EQ(refusal.reason, setting.bounds.reason);
    }
  }
}

TEST(ConfigurationBounds, no_number_and_nothing_positive_have_errors_of_their_own) {
  for (const Setting& setting : settings()) {
    Configuration c = test::whole_configuration();
    setting.set(c, kNan);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite) << setting.name;
    // The receivers' sigma is judged by the measurement first.
    if (std::string_view(setting.name) == "sensor.range_sigma") continue;
    EXPECT_EQ(test::failure_of(check(c)).setting, setting.name);
    for (const double value : {0.0, -1.0}) {
      c = test::whole_configuration();
      setting.set(c, value);
      const ConfigurationRefusal refusal = test::failure_of(check(c));
      EXPECT_EQ(refusal.setting, setting.name);
      EXPECT_EQ(refusal.error, Error::kNotPositive) << setting.name;
      EXPECT_EQ(refusal.found, value);
      EXPECT_EQ(refusal.needed, setting.bounds.lowest);
    }
  }
}

struct Lasting {
  const char* name;
  Bounds bounds;
  hal::Duration& (*of)(Configuration& c);
};

TEST(ConfigurationBounds, hold_for_durations_to_the_nanosecond) {
  using C = Configuration;
  for (const Lasting& setting : {
           Lasting{"supervision.latest_tick", plausible::kLatestTick,
                   [](C& c) -> hal::Duration& { return c.supervision.latest_tick; }},
           Lasting{"sensor.reading_timeout", plausible::kReadingTimeout,
                   [](C& c) -> hal::Duration& { return c.sensor.reading_timeout; }},
           Lasting{"dwell.settle", plausible::kSettle,
                   [](C& c) -> hal::Duration& { return c.dwell.settle; }},
           Lasting{"dwell.settle_timeout", plausible::kSettleTimeout,
                   [](C& c) -> hal::Duration& { return c.dwell.settle_timeout; }},
           Lasting{"grid.dwell", plausible::kGridDwell,
                   [](C& c) -> hal::Duration& { return c.grid.dwell; }},
       }) {
    for (const bool high : {false, true}) {
      const hal::Duration bound = lasting_s(high ? setting.bounds.highest : setting.bounds.lowest);
      Configuration c = test::whole_configuration();
      setting.of(c) = bound;
      EXPECT_TRUE(check(c)) << setting.name;
      setting.of(c) += hal::Duration(high ? 1 : -1);
      EXPECT_EQ(test::failure_of(check(c)).setting, setting.name);
    }
  }
}

TEST(ConfigurationBounds, of_the_period) {
  for (const int us : {100, 50000}) {
    Configuration c = test::whole_configuration();
    for (double& error : c.supervision.following_error) error = 1;
    c.period = std::chrono::microseconds(us);
    EXPECT_TRUE(check(c)) << us;
    c.period += std::chrono::nanoseconds(us == 100 ? -1 : 1);
    EXPECT_EQ(test::failure_of(check(c)).setting, "period");
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kPeriodInvalid);
    EXPECT_EQ(test::failure_of(check(c)).found, hal::seconds(c.period));
    EXPECT_EQ(test::failure_of(check(c)).needed, 0.05);
  }
}

struct Count {
  const char* name;
  std::size_t least;
  std::size_t most;
  std::size_t& (*of)(Configuration& c);
};

TEST(ConfigurationBounds, of_counts) {
  using C = Configuration;
  for (const Count& setting : {
           Count{"sweeps.points", 6, 48, [](C& c) -> std::size_t& { return c.sweeps.points; }},
           Count{"sweeps.most_points", 24, kMostSweepPoints,
                 [](C& c) -> std::size_t& { return c.sweeps.most_points; }},
           Count{"sweeps.validation_poses", 3, kMostHeldOut,
                 [](C& c) -> std::size_t& { return c.sweeps.validation_poses; }},
           Count{"dwell.pings", 1, 15, [](C& c) -> std::size_t& { return c.dwell.pings; }},
           Count{"dwell.most_pings", 5, measurement::kMaxPings,
                 [](C& c) -> std::size_t& { return c.dwell.most_pings; }},
           Count{"grid.count", 2, 128, [](C& c) -> std::size_t& { return c.grid.grid.count[1]; }},
       }) {
    for (const bool high : {false, true}) {
      const std::size_t bound = high ? setting.most : setting.least;
      Configuration c = test::whole_configuration();
      setting.of(c) = bound;
      EXPECT_TRUE(check(c)) << setting.name << " " << bound;
      setting.of(c) = high ? bound + 1 : bound - 1;
      const ConfigurationRefusal refusal = test::failure_of(check(c));
      EXPECT_EQ(refusal.error, Error::kOutOfRange) << setting.name << " " << setting.of(c);
      const bool of_points = std::string_view(setting.name) == "sweeps.most_points" && !high;
      const bool of_pings = std::string_view(setting.name) == "dwell.pings" && high;
      if (of_points) {
        EXPECT_EQ(refusal.setting, "sweeps.points") << "more than most_points";
      } else if (of_pings) {
        EXPECT_EQ(refusal.setting, "dwell.most_pings") << "fewer than pings";
      } else {
        EXPECT_EQ(refusal.setting, setting.name);
      }
    }
  }
}

TEST(ConfigurationBounds, of_lists_are_one_for_each_joint_and_named_with_theirs) {
  using C = Configuration;
  struct List {
    const char* name;
    JointVector& (*of)(C& c);
  };
  for (const List& list : {
           List{"limits.speed", [](C& c) -> JointVector& { return c.limits.speed; }},
           List{"limits.acceleration", [](C& c) -> JointVector& { return c.limits.acceleration; }},
           List{"supervision.following_error",
                [](C& c) -> JointVector& { return c.supervision.following_error; }},
       }) {
    for (std::size_t joint = 0; joint < 6; ++joint) {
      Configuration c = test::whole_configuration();
      list.of(c)[joint] = 1e9;
      EXPECT_EQ(test::failure_of(check(c)).setting, list.name);
      EXPECT_EQ(test::failure_of(check(c)).joint, joint);
    }
    Configuration c = test::whole_configuration();
    list.of(c).resize(5);
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, list.name);
    EXPECT_EQ(refusal.error, Error::kOutOfRange);
    EXPECT_EQ(refusal.found, 5);
    EXPECT_EQ(refusal.needed, 6);
  }
}

TEST(ConfigurationBounds, of_slides_are_others_than_of_turning_joints) {
  Configuration c = test::whole_configuration();
  c.grid = {};
  c.drawing.joints[0].type = JointType::kPrismatic;
  c.drawing.limits[0] = {-1, 1};
  c.limits.speed[0] = 20;
  c.supervision.following_error[0] = 0.1;
  EXPECT_TRUE(check(c));
  c.limits.speed[0] = 20.1;
  EXPECT_EQ(test::failure_of(check(c)).needed, 20);
  c.limits.speed[0] = 1;
  c.drawing.limits[0] = {-1, 100.1};
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsImplausible);
  EXPECT_EQ(test::failure_of(check(c)).needed, 100);
}

}  // namespace
}  // namespace armsig::controller
