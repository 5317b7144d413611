// SPDX-License-Identifier: MIT
// Every bound of the configuration from both sides: what is just within is accepted, what is just
// beyond is refused by the name of its setting, with what was found and what is needed.
#include <chrono>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/controller/measurement_log.hpp"
#include "firmware/controller/plausibility.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::controller {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A whole configuration with a grid, in which nothing is near its bounds.
Configuration good() {
  Configuration c = test::puma_controller();
  for (JointVector& q : c.grid.taught) q = c.sweeps.configuration;
  c.grid.taught[1][0] += 0.3;
  c.grid.taught[2][1] += 0.3;
  c.grid.grid.size_m = {0.1, 0.1, 0.1};
  c.grid.grid.count = {2, 2, 2};
  return c;
}

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
      {"limits.speed", plausible::kSpeed.revolute, [](C& c, double v) { c.limits.speed[3] = v; }},
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
      {"sweeps.held_out_reach", plausible::kHeldOutReach,
       [](C& c, double v) { c.sweeps.held_out_reach = v; }},
      {"grid.size", plausible::kGridSize, [](C& c, double v) { c.grid.grid.size_m[2] = v; }},
  };
  return all;
}

TEST(ConfigurationBounds, are_part_of_what_is_accepted) {
  for (const Setting& setting : settings()) {
    for (const double value : {setting.bounds.lowest, setting.bounds.highest}) {
      Configuration c = good();
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
      Configuration c = good();
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
    Configuration c = good();
    setting.set(c, kNan);
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite) << setting.name;
    // The receivers' sigma is judged by the measurement first.
    if (std::string_view(setting.name) == "sensor.range_sigma") continue;
    EXPECT_EQ(test::failure_of(check(c)).setting, setting.name);
    for (const double value : {0.0, -1.0}) {
      c = good();
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
      Configuration c = good();
      setting.of(c) = bound;
      EXPECT_TRUE(check(c)) << setting.name;
      setting.of(c) += hal::Duration(high ? 1 : -1);
      EXPECT_EQ(test::failure_of(check(c)).setting, setting.name);
    }
  }
}

TEST(ConfigurationBounds, of_the_period) {
  for (const int us : {100, 50000}) {
    Configuration c = good();
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
           Count{"sweeps.held_out_poses", 3, kMostHeldOut,
                 [](C& c) -> std::size_t& { return c.sweeps.held_out_poses; }},
           Count{"dwell.pings", 1, 15, [](C& c) -> std::size_t& { return c.dwell.pings; }},
           Count{"dwell.most_pings", 5, measurement::kMaxPings,
                 [](C& c) -> std::size_t& { return c.dwell.most_pings; }},
           Count{"grid.count", 2, 128, [](C& c) -> std::size_t& { return c.grid.grid.count[1]; }},
       }) {
    for (const bool high : {false, true}) {
      const std::size_t bound = high ? setting.most : setting.least;
      Configuration c = good();
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
      Configuration c = good();
      list.of(c)[joint] = 1e9;
      EXPECT_EQ(test::failure_of(check(c)).setting, list.name);
      EXPECT_EQ(test::failure_of(check(c)).joint, joint);
    }
    Configuration c = good();
    list.of(c).resize(5);
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, list.name);
    EXPECT_EQ(refusal.error, Error::kOutOfRange);
    EXPECT_EQ(refusal.found, 5);
    EXPECT_EQ(refusal.needed, 6);
  }
}

TEST(ConfigurationBounds, of_slides_are_others_than_of_turning_joints) {
  Configuration c = good();
  c.grid = {};
  c.drawing.joints[0].type = JointType::kPrismatic;
  c.drawing.limits[0] = {-1, 1};
  c.limits.speed[0] = 20;
  EXPECT_TRUE(check(c));
  c.limits.speed[0] = 20.1;
  EXPECT_EQ(test::failure_of(check(c)).needed, 20);
  c.limits.speed[0] = 1;
  c.drawing.limits[0] = {-1, 100.1};
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsImplausible);
  EXPECT_EQ(test::failure_of(check(c)).needed, 100);
}

TEST(ConfigurationArm, is_refused_by_what_is_wrong_with_it) {
  Configuration none = good();
  none.drawing.joints.clear();
  EXPECT_EQ(test::failure_of(check(none)).error, Error::kTooFewAxes);
  EXPECT_EQ(test::failure_of(check(none)).found, 0);
  EXPECT_EQ(test::failure_of(check(none)).needed, 1);
  Configuration few = good();
  few.drawing.limits.resize(5);
  EXPECT_EQ(test::failure_of(check(few)).setting, "arm.limits");
  EXPECT_EQ(test::failure_of(check(few)).error, Error::kOutOfRange);
  for (double DhJoint::* part :
       {&DhJoint::theta_rad, &DhJoint::d_m, &DhJoint::a_m, &DhJoint::alpha_rad}) {
    Configuration c = good();
    c.drawing.joints[4].*part = kNan;
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, "arm.joints");
    EXPECT_EQ(refusal.error, Error::kNotFinite);
    EXPECT_EQ(refusal.joint, 4U);
  }
  for (double JointLimits::* end : {&JointLimits::lower, &JointLimits::upper}) {
    Configuration c = good();
    c.drawing.limits[5].*end = kNan;
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite);
    EXPECT_EQ(test::failure_of(check(c)).joint, 5U);
  }
  Configuration equal = good();
  equal.drawing.limits[5] = {0.5, 0.5};
  EXPECT_EQ(test::failure_of(check(equal)).error, Error::kLimitsReversed);
}

TEST(ConfigurationArm, has_couplings_between_its_own_joints_that_lead_nowhere_back) {
  Configuration c = good();
  c.drawing.couplings.push_back({.joint = 5, .from = 4, .ratio = 0.5});
  EXPECT_TRUE(check(c));
  c.drawing.couplings[0].ratio = kNan;
  EXPECT_EQ(test::failure_of(check(c)).setting, "arm.coupling");
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite);
  c.drawing.couplings[0] = {.joint = 6, .from = 4, .ratio = 0.5};
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  c.drawing.couplings[0] = {.joint = 5, .from = 6, .ratio = 0.5};
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  c.drawing.couplings[0] = {.joint = 5, .from = 4, .ratio = 0.5};
  c.drawing.couplings.push_back({.joint = 4, .from = 5, .ratio = 0.5});
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kUnsupported);
}

TEST(ConfigurationReadings, are_within_the_limits_one_for_each_joint) {
  for (const bool taught : {false, true}) {
    const auto readings = [taught](Configuration& c) -> JointVector& {
      return taught ? c.grid.taught[2] : c.sweeps.configuration;
    };
    const char* name = taught ? "grid.taught" : "sweeps.configuration";
    Configuration c = good();
    readings(c)[4] = c.drawing.limits[4].upper + 1e-9;
    ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, name);
    EXPECT_EQ(refusal.error, Error::kJointLimit);
    EXPECT_EQ(refusal.joint, 4U);
    EXPECT_EQ(refusal.found, c.drawing.limits[4].upper + 1e-9);
    EXPECT_EQ(refusal.needed, c.drawing.limits[4].upper);
    readings(c)[4] = c.drawing.limits[4].lower - 1e-9;
    refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.error, Error::kJointLimit);
    EXPECT_EQ(refusal.needed, c.drawing.limits[4].lower);
    readings(c)[4] = kNan;
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite);
    EXPECT_EQ(test::failure_of(check(c)).joint, 4U);
    readings(c).resize(5);
    refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.error, Error::kOutOfRange);
    EXPECT_EQ(refusal.found, 5);
    EXPECT_EQ(refusal.needed, 6);
  }
  Configuration at_its_limit = good();
  at_its_limit.sweeps.configuration[4] = at_its_limit.drawing.limits[4].upper;
  EXPECT_TRUE(check(at_its_limit));
  at_its_limit.sweeps.configuration[4] = at_its_limit.drawing.limits[4].lower;
  EXPECT_TRUE(check(at_its_limit));
}

TEST(ConfigurationSensor, hears_in_an_order_of_temperatures_and_stands_near) {
  Configuration c = good();
  c.sensor.lowest_air_celsius = c.sensor.highest_air_celsius;
  EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.air");
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsReversed);
  c = good();
  c.sensor.lowest_air_celsius = -40;
  c.sensor.highest_air_celsius = 85;
  EXPECT_TRUE(check(c));
  c.sensor.lowest_air_celsius = -40.1;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  for (const int axis : {0, 1, 2}) {
    for (const double way : {-1.0, 1.0}) {
      c = good();
      c.sensor.receivers.p_S[7](axis) = way * 100.1;
      EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.receivers");
      EXPECT_EQ(test::failure_of(check(c)).needed, way * 100);
    }
  }
  c = good();
  c.sensor.receivers.p_S.clear();
  EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.receivers");
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kTooFewReceivers);
}

TEST(ConfigurationDwell, is_finer_than_following_and_no_finer_than_a_count) {
  Configuration c = good();
  c.supervision.following_error[4] = 2e-4;
  EXPECT_TRUE(check(c));
  c.supervision.following_error[4] = c.dwell.tolerance;
  ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "dwell.tolerance");
  EXPECT_EQ(refusal.joint, 4U);
  EXPECT_EQ(refusal.needed, c.dwell.tolerance);
  c = good();
  for (int i = 0; i < 6; ++i) c.resolution.push_back(1e-5);
  c.resolution[5] = c.dwell.tolerance;
  EXPECT_TRUE(check(c));
  c.resolution[5] = 1.01 * c.dwell.tolerance;
  refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.error, Error::kToleranceTooFine);
  EXPECT_EQ(refusal.joint, 5U);
  EXPECT_EQ(refusal.found, c.dwell.tolerance);
  EXPECT_EQ(refusal.needed, c.resolution[5]);
}

TEST(ConfigurationGrid, is_taught_at_three_places_that_are_not_in_a_line) {
  // A joint that moves the tool of the taught readings by less than a millimetre teaches nothing.
  for (const std::size_t corner : {1U, 2U}) {
    Configuration c = good();
    c.grid.taught[corner] = c.grid.taught[0];
    c.grid.taught[corner][0] += 1e-4;
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, "grid.taught");
    EXPECT_EQ(refusal.error, Error::kCoincidentPoints);
    EXPECT_GT(refusal.found, 0);
    EXPECT_LT(refusal.found, 1e-3);
    EXPECT_EQ(refusal.needed, 1e-3);
  }
  Configuration same = good();
  same.grid.taught[2] = same.grid.taught[1];
  EXPECT_EQ(test::failure_of(check(same)).error, Error::kCoincidentPoints);
  // Three places of one short arc are a line, but for a fiftieth of a millimetre.
  Configuration line = good();
  line.grid.taught[1] = line.grid.taught[2] = line.grid.taught[0];
  line.grid.taught[1][0] += 0.02;
  line.grid.taught[2][0] += 0.01;
  const ConfigurationRefusal in_a_line = test::failure_of(check(line));
  EXPECT_EQ(in_a_line.error, Error::kCoincidentPoints);
  EXPECT_LT(in_a_line.found, 1e-3);
  Configuration part = good();
  part.grid.taught[1].clear();
  EXPECT_EQ(test::failure_of(check(part)).setting, "grid.taught");
  Configuration none = good();
  none.grid.taught = {};
  none.grid.grid.size_m[0] = -1;
  EXPECT_TRUE(check(none)) << "no grid is set up";
  Configuration many = good();
  many.grid.grid.count = {8, 8, 9};
  EXPECT_EQ(test::failure_of(check(many)).setting, "grid.count");
  many.grid.grid.count = {2, 2, 513};
  EXPECT_EQ(test::failure_of(check(many)).found, 513) << "along one edge";
  many.grid.grid.count = {3, 9, 19};
  EXPECT_EQ(test::failure_of(check(many)).found, 513);
  many.grid.grid.count = {8, 8, 8};
  EXPECT_TRUE(check(many));
}

}  // namespace
}  // namespace armsig::controller
