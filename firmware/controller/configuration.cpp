// SPDX-License-Identifier: MIT
#include "firmware/controller/configuration.hpp"

#include <algorithm>
#include <cmath>

#include "core/measurement/ping_median.hpp"
#include "firmware/controller/check_history.hpp"
#include "firmware/controller/configuration_checks.hpp"
#include "firmware/controller/measurement_log.hpp"
#include "firmware/controller/sweep.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::controller {
namespace {

// Every coupling is finite, of a joint with one before or after it, and none leads back: readings
// that are solved for couple to the same effective ones.
Checked check_couplings(const Arm& arm) {
  JointVector effective;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    effective.push_back(1 + static_cast<double>(i));
  }
  for (const JointCoupling& coupling : arm.couplings) {
    if (!std::isfinite(coupling.ratio)) return refused("arm.coupling", Error::kNotFinite);
    if (std::max(coupling.joint, coupling.from) >= arm.joints.size()) {
      return refused("arm.coupling", Error::kOutOfRange);
    }
  }
  const JointVector again =
      effective_readings(arm.couplings, readings_for(arm.couplings, effective));
  for (std::size_t i = 0; i < again.size(); ++i) {
    constexpr double kRounding = 1e-9;
    if (!(std::abs(again[i] - effective[i]) < kRounding)) {
      return refused("arm.coupling", Error::kUnsupported, i);
    }
  }
  return {};
}

Checked check_arm(const Arm& arm) {
  if (arm.joints.empty()) return refused("arm.joints", Error::kTooFewAxes, {}, 0, 1);
  if (auto ok = check_couplings(arm); !ok) return ok;
  if (arm.limits.size() != arm.joints.size()) return refused("arm.limits", Error::kOutOfRange);
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    const DhJoint& row = arm.joints[i];
    const auto [lower, upper] = arm.limits[i];
    if (!std::isfinite(row.theta_rad + row.d_m + row.a_m + row.alpha_rad)) {
      return refused("arm.joints", Error::kNotFinite, i);
    }
    if (!std::isfinite(lower + upper)) return refused("arm.limits", Error::kNotFinite, i);
    if (!(lower < upper)) return refused("arm.limits", Error::kLimitsReversed, i, lower, upper);
    for (const double limit : {lower, upper}) {
      auto ok = check_plausible("arm.limits", limit, plausible::kLimit.of(row.type),
                                Error::kLimitsImplausible, i);
      if (!ok) return ok;
    }
  }
  return {};
}

Checked check_motion(const Configuration& c) {
  if (c.period < std::chrono::microseconds(100) || c.period > std::chrono::milliseconds(50)) {
    return refused("period", Error::kPeriodInvalid, {}, hal::seconds(c.period), 0.05);
  }
  const Arm& arm = c.drawing;
  for (auto ok : {
           check_each("limits.speed", c.limits.speed, arm, plausible::kSpeed),
           check_each("limits.acceleration", c.limits.acceleration, arm, plausible::kAcceleration),
           check_plausible("limits.tool_speed", c.limits.tool_speed, plausible::kToolSpeed),
           check_plausible("limits.tool_turn_rate", c.limits.tool_turn_rate,
                           plausible::kToolTurnRate),
           check_plausible("limits.least_regularity", c.limits.least_regularity,
                           plausible::kLeastRegularity),
           check_each("supervision.following_error", c.supervision.following_error, arm,
                      plausible::kFollowingError),
           check_plausible("supervision.latest_tick", hal::seconds(c.supervision.latest_tick),
                           plausible::kLatestTick),
       }) {
    if (!ok) return ok;
  }
  return {};
}

#ifndef ARMSIG_RANGES_ALONE
// Of an instrument of points, or where there is none.
Checked check_points(const Configuration& c) {
  if (c.sensor.measures == Measures::kNothing) {
    if (c.check.every <= hal::Duration{}) return {};
    return refused("check.every", Error::kNoSensor, {}, hal::seconds(c.check.every), 0);
  }
  if (auto ok = check_plausible("sensor.point_sigma", c.sensor.point_sigma_m,
                                plausible::kInstrumentSigma);
      !ok) {
    return ok;
  }
  return check_plausible("sensor.reading_timeout", hal::seconds(c.sensor.reading_timeout),
                         plausible::kReadingTimeout);
}
#endif

Checked check_sensor(const Configuration& c) {
#ifndef ARMSIG_RANGES_ALONE
  if (c.sensor.measures != Measures::kRanges) return check_points(c);
#endif
  if (const auto array = measurement::check(c.sensor.receivers); !array) {
    return refused("sensor.receivers", array.error());
  }
  if (!(c.sensor.lowest_air_celsius < c.sensor.highest_air_celsius)) {
    return refused("sensor.air", Error::kLimitsReversed, {}, c.sensor.lowest_air_celsius,
                   c.sensor.highest_air_celsius);
  }
  for (const Vector3& p_S : c.sensor.receivers.p_S) {
    for (const double coordinate : p_S) {
      auto ok = check_plausible("sensor.receivers", coordinate, plausible::kReceiver);
      if (!ok) return ok;
    }
  }
  for (auto ok : {
           check_plausible("sensor.range_sigma", c.sensor.receivers.range_sigma_m,
                           plausible::kRangeSigma),
           check_plausible("sensor.air", c.sensor.lowest_air_celsius, plausible::kAir),
           check_plausible("sensor.air", c.sensor.highest_air_celsius, plausible::kAir),
           check_plausible("sensor.largest_air_step", c.sensor.largest_air_step_kelvin,
                           plausible::kAirStep),
           check_plausible("sensor.reading_timeout", hal::seconds(c.sensor.reading_timeout),
                           plausible::kReadingTimeout),
       }) {
    if (!ok) return ok;
  }
  return {};
}

Checked check_dwell(const Configuration& c) {
  for (auto ok : {
           check_plausible("dwell.tolerance", c.dwell.tolerance, plausible::kDwellTolerance),
           check_plausible("dwell.settle", hal::seconds(c.dwell.settle), plausible::kSettle),
       }) {
    if (!ok) return ok;
  }
  // Else a joint that stands still within its tolerance faults, or none is ever at rest.
  for (std::size_t i = 0; i < c.supervision.following_error.size(); ++i) {
    if (c.dwell.tolerance < c.supervision.following_error[i]) continue;
    return std::unexpected(ConfigurationRefusal{
        .setting = "dwell.tolerance",
        .error = Error::kOutOfRange,
        .joint = i,
        .found = c.dwell.tolerance,
        .needed = c.supervision.following_error[i],
        .reason = "a joint within the tolerance would be beyond its following error"});
  }
  for (std::size_t i = 0; i < c.resolution.size(); ++i) {
    if (c.dwell.tolerance < c.resolution[i]) {
      return refused("dwell.tolerance", Error::kToleranceTooFine, i, c.dwell.tolerance,
                     c.resolution[i]);
    }
  }
  if (auto ok = check_plausible("dwell.settle_timeout", hal::seconds(c.dwell.settle_timeout),
                                plausible::kSettleTimeout);
      !ok) {
    return ok;
  }
  if (auto ok = check_count("dwell.pings", c.dwell.pings, 1, measurement::kMaxPings); !ok) {
    return ok;
  }
  return check_count("dwell.most_pings", c.dwell.most_pings, c.dwell.pings, measurement::kMaxPings);
}

// A tick reads what the drive had reached of the command of two ticks before: at full speed a joint
// is that far behind although it follows.
Checked check_lag(const Configuration& c) {
  for (std::size_t i = 0; i < c.supervision.following_error.size(); ++i) {
    const double lag = 2 * hal::seconds(c.period) * c.limits.speed[i];
    if (lag < c.supervision.following_error[i]) continue;
    return std::unexpected(ConfigurationRefusal{
        .setting = "supervision.following_error",
        .error = Error::kOutOfRange,
        .joint = i,
        .found = c.supervision.following_error[i],
        .needed = lag,
        .reason = "two periods at its full speed take a joint farther than its following error"});
  }
  return {};
}

Checked check_sweeps(const Configuration& c) {
  const SweepPlan& plan = c.sweeps;
  if (auto ok = check_readings("sweeps.configuration", plan.configuration, c.drawing); !ok) {
    return ok;
  }
  for (std::size_t i = 0; i < c.drawing.joints.size(); ++i) {
    if (auto ok = check_plausible("sweeps.arc", arc_of(plan, i), plausible::kArc); !ok) return ok;
  }
  if (auto ok = check_count("sweeps.points", plan.points, 6, plan.most_points); !ok) return ok;
  const std::size_t logged = (kMostLogged - kMostHeldOut) / c.drawing.joints.size();
  const std::size_t most = std::min(kMostSweepPoints, logged);
  if (auto ok = check_count("sweeps.most_points", plan.most_points, 6, most); !ok) return ok;
  for (auto ok : {
           check_plausible("sweeps.axis_sigma", plan.axis_sigma_rad, plausible::kAxisSigma),
           check_plausible("sweeps.point_sigma", plan.point_sigma_m, plausible::kPointSigma),
           check_plausible("sweeps.validation_reach", plan.validation_reach,
                           plausible::kHeldOutReach),
       }) {
    if (!ok) return ok;
  }
  if (auto ok = check_count("sweeps.validation_poses", plan.validation_poses, 3, kMostHeldOut);
      !ok) {
    return ok;
  }
  if (auto ok = check_workspace(c); !ok) return ok;
  return check_count("check.poses", c.check.poses, kFewestCheckPoses, kMostCheckPoses);
}

}  // namespace

Checked check(const Configuration& configuration) {
  for (const auto part :
       {check_motion, check_sensor, check_dwell, check_lag, check_sweeps, check_grid}) {
    if (auto arm = check_arm(configuration.drawing); !arm) return arm;
    if (auto checked = part(configuration); !checked) return checked;
  }
  return {};
}

}  // namespace armsig::controller
