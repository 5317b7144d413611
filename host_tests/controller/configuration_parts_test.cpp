// SPDX-License-Identifier: MIT
// What the parts of a configuration must be to each other: an arm with its limits and couplings,
// readings within them, a sensor near by, a tolerance between following and counts, a grid's
// corners.

#include <gtest/gtest.h>

#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"
#include "host_tests/support/whole_configuration.hpp"

namespace armsig::controller {
namespace {

using test::kNan;

TEST(ConfigurationArm, is_refused_by_what_is_wrong_with_it) {
  Configuration none = test::whole_configuration();
  none.drawing.joints.clear();
  EXPECT_EQ(test::failure_of(check(none)).error, Error::kTooFewAxes);
  EXPECT_EQ(test::failure_of(check(none)).found, 0);
  EXPECT_EQ(test::failure_of(check(none)).needed, 1);
  Configuration few = test::whole_configuration();
  few.drawing.limits.resize(5);
  EXPECT_EQ(test::failure_of(check(few)).setting, "arm.limits");
  EXPECT_EQ(test::failure_of(check(few)).error, Error::kOutOfRange);
  for (double DhJoint::* part :
       {&DhJoint::theta_rad, &DhJoint::d_m, &DhJoint::a_m, &DhJoint::alpha_rad}) {
    Configuration c = test::whole_configuration();
    c.drawing.joints[4].*part = kNan;
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, "arm.joints");
    EXPECT_EQ(refusal.error, Error::kNotFinite);
    EXPECT_EQ(refusal.joint, 4U);
  }
  for (double JointLimits::* end : {&JointLimits::lower, &JointLimits::upper}) {
    Configuration c = test::whole_configuration();
    c.drawing.limits[5].*end = kNan;
    EXPECT_EQ(test::failure_of(check(c)).error, Error::kNotFinite);
    EXPECT_EQ(test::failure_of(check(c)).joint, 5U);
  }
  Configuration equal = test::whole_configuration();
  equal.drawing.limits[5] = {0.5, 0.5};
  EXPECT_EQ(test::failure_of(check(equal)).error, Error::kLimitsReversed);
}

TEST(ConfigurationArm, has_couplings_between_its_own_joints_that_lead_nowhere_back) {
  Configuration c = test::whole_configuration();
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
    Configuration c = test::whole_configuration();
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
  Configuration at_its_limit = test::whole_configuration();
  at_its_limit.sweeps.configuration[4] = at_its_limit.drawing.limits[4].upper;
  EXPECT_TRUE(check(at_its_limit));
  at_its_limit.sweeps.configuration[4] = at_its_limit.drawing.limits[4].lower;
  EXPECT_TRUE(check(at_its_limit));
}

TEST(ConfigurationSensor, hears_in_an_order_of_temperatures_and_stands_near) {
  Configuration c = test::whole_configuration();
  c.sensor.lowest_air_celsius = c.sensor.highest_air_celsius;
  EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.air");
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kLimitsReversed);
  c = test::whole_configuration();
  c.sensor.lowest_air_celsius = -40;
  c.sensor.highest_air_celsius = 85;
  EXPECT_TRUE(check(c));
  c.sensor.lowest_air_celsius = -40.1;
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kOutOfRange);
  for (const int axis : {0, 1, 2}) {
    for (const double way : {-1.0, 1.0}) {
      c = test::whole_configuration();
      c.sensor.receivers.p_S[7](axis) = way * 100.1;
      EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.receivers");
      EXPECT_EQ(test::failure_of(check(c)).needed, way * 100);
    }
  }
  c = test::whole_configuration();
  c.sensor.receivers.p_S.clear();
  EXPECT_EQ(test::failure_of(check(c)).setting, "sensor.receivers");
  EXPECT_EQ(test::failure_of(check(c)).error, Error::kTooFewReceivers);
}

TEST(ConfigurationSupervision, allows_what_a_joint_that_follows_is_behind_at_full_speed) {
  Configuration c = test::whole_configuration();
  const double lag = 2 * hal::seconds(c.period) * c.limits.speed[2];
  c.supervision.following_error[2] = 1.01 * lag;
  EXPECT_TRUE(check(c));
  c.supervision.following_error[2] = 0.99 * lag;
  const ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "supervision.following_error");
  EXPECT_EQ(refusal.joint, 2U);
  EXPECT_EQ(refusal.found, 0.99 * lag);
  EXPECT_EQ(refusal.needed, lag);
  EXPECT_NE(refusal.reason, "");
}

TEST(ConfigurationDwell, is_finer_than_following_and_no_finer_than_a_count) {
  Configuration c = test::whole_configuration();
  c.limits.speed[4] = 1e-3;
  c.supervision.following_error[4] = 2e-4;
  EXPECT_TRUE(check(c));
  c.supervision.following_error[4] = c.dwell.tolerance;
  ConfigurationRefusal refusal = test::failure_of(check(c));
  EXPECT_EQ(refusal.setting, "dwell.tolerance");
  EXPECT_EQ(refusal.joint, 4U);
  EXPECT_EQ(refusal.needed, c.dwell.tolerance);
  c = test::whole_configuration();
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

// A hand that was turned where it is teaches another place of a tool that is out of its axis.
TEST(ConfigurationGrid, may_be_taught_by_turning_the_hand) {
  Configuration c = test::whole_configuration();
  c.grid.taught[1] = c.grid.taught[0];
  c.grid.taught[1][5] += 0.5;
  EXPECT_TRUE(check(c));
}

TEST(ConfigurationGrid, is_taught_at_three_places_that_are_not_in_a_line) {
  // A joint that moves the tool of the taught readings by less than a millimetre teaches nothing.
  for (const std::size_t corner : {1U, 2U}) {
    Configuration c = test::whole_configuration();
    c.grid.taught[corner] = c.grid.taught[0];
    c.grid.taught[corner][0] += 1e-4;
    const ConfigurationRefusal refusal = test::failure_of(check(c));
    EXPECT_EQ(refusal.setting, "grid.taught");
    EXPECT_EQ(refusal.error, Error::kCoincidentPoints);
    EXPECT_GT(refusal.found, 0);
    EXPECT_LT(refusal.found, 1e-3);
    EXPECT_EQ(refusal.needed, 1e-3);
  }
  Configuration same = test::whole_configuration();
  same.grid.taught[2] = same.grid.taught[1];
  EXPECT_EQ(test::failure_of(check(same)).error, Error::kCoincidentPoints);
  // Three places of one short arc are a line, but for a fiftieth of a millimetre.
  Configuration line = test::whole_configuration();
  line.grid.taught[1] = line.grid.taught[2] = line.grid.taught[0];
  line.grid.taught[1][0] += 0.02;
  line.grid.taught[2][0] += 0.01;
  const ConfigurationRefusal in_a_line = test::failure_of(check(line));
  EXPECT_EQ(in_a_line.error, Error::kCoincidentPoints);
  EXPECT_LT(in_a_line.found, 1e-3);
  Configuration part = test::whole_configuration();
  part.grid.taught[1].clear();
  EXPECT_EQ(test::failure_of(check(part)).setting, "grid.taught");
  Configuration none = test::whole_configuration();
  none.grid.taught = {};
  none.grid.grid.size_m[0] = -1;
  EXPECT_TRUE(check(none)) << "no grid is set up";
  Configuration many = test::whole_configuration();
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
