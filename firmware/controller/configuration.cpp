// SPDX-License-Identifier: MIT
#include "firmware/controller/configuration.hpp"

#include <algorithm>
#include <cmath>

#include "core/measurement/ping_median.hpp"
#include "firmware/controller/measurement_log.hpp"
#include "hal/range_sensor.hpp"

namespace armsig::controller {
namespace {

using Checked = std::expected<void, ConfigurationRefusal>;

constexpr double kLargestRevolute_rad = 20 * kPi;
constexpr double kLargestPrismatic_m = 100;

std::unexpected<ConfigurationRefusal> refused(std::string_view setting, Error error,
                                              std::optional<std::size_t> joint = {},
                                              double found = 0, double needed = 0) {
  return std::unexpected(ConfigurationRefusal{setting, error, joint, found, needed});
}

Checked check_positive(std::string_view setting, double value,
                       std::optional<std::size_t> joint = {}) {
  if (!std::isfinite(value)) return refused(setting, Error::kNotFinite, joint);
  if (!(value > 0)) return refused(setting, Error::kNotPositive, joint, value, 0);
  return {};
}

Checked check_each_positive(std::string_view setting, const JointVector& values,
                            std::size_t joints) {
  if (values.size() != joints) {
    return refused(setting, Error::kOutOfRange, {}, static_cast<double>(values.size()),
                   static_cast<double>(joints));
  }
  for (std::size_t i = 0; i < joints; ++i) {
    if (auto checked = check_positive(setting, values[i], i); !checked) return checked;
  }
  return {};
}

Checked check_count(std::string_view setting, std::size_t count, std::size_t least,
                    std::size_t most) {
  if (count >= least && count <= most) return {};
  return refused(setting, Error::kOutOfRange, {}, static_cast<double>(count),
                 static_cast<double>(count < least ? least : most));
}

Checked check_readings(std::string_view setting, const JointVector& q, const Arm& arm) {
  if (q.size() != arm.joints.size()) {
    return refused(setting, Error::kOutOfRange, {}, static_cast<double>(q.size()),
                   static_cast<double>(arm.joints.size()));
  }
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto [lower, upper] = arm.limits[i];
    if (!std::isfinite(q[i])) return refused(setting, Error::kNotFinite, i);
    if (q[i] < lower || q[i] > upper) {
      return refused(setting, Error::kJointLimit, i, q[i], q[i] < lower ? lower : upper);
    }
  }
  return {};
}

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
    const double largest =
        row.type == JointType::kRevolute ? kLargestRevolute_rad : kLargestPrismatic_m;
    if (std::max(-lower, upper) > largest) {
      return refused("arm.limits", Error::kLimitsImplausible, i, std::max(-lower, upper), largest);
    }
  }
  return {};
}

Checked check_motion(const Configuration& c) {
  const std::size_t n = c.drawing.joints.size();
  if (c.period < std::chrono::microseconds(100) || c.period > std::chrono::milliseconds(50)) {
    return refused("period", Error::kPeriodInvalid, {}, hal::seconds(c.period), 0.05);
  }
  if (auto ok = check_each_positive("limits.speed", c.limits.speed, n); !ok) return ok;
  if (auto ok = check_each_positive("limits.acceleration", c.limits.acceleration, n); !ok) {
    return ok;
  }
  if (auto ok = check_positive("limits.tool_speed", c.limits.tool_speed); !ok) return ok;
  if (auto ok = check_positive("limits.tool_turn_rate", c.limits.tool_turn_rate); !ok) return ok;
  if (auto ok = check_positive("limits.least_regularity", c.limits.least_regularity); !ok) {
    return ok;
  }
  if (auto ok =
          check_each_positive("supervision.following_error", c.supervision.following_error, n);
      !ok) {
    return ok;
  }
  return check_positive("supervision.latest_tick", hal::seconds(c.supervision.latest_tick));
}

Checked check_measuring(const Configuration& c) {
  if (const auto array = measurement::check(c.sensor.receivers); !array) {
    return refused("sensor.receivers", array.error());
  }
  if (!(c.sensor.lowest_air_celsius < c.sensor.highest_air_celsius)) {
    return refused("sensor.air", Error::kLimitsReversed, {}, c.sensor.lowest_air_celsius,
                   c.sensor.highest_air_celsius);
  }
  if (auto ok = check_positive("sensor.largest_air_step", c.sensor.largest_air_step_kelvin); !ok) {
    return ok;
  }
  if (auto ok = check_positive("sensor.reading_timeout", hal::seconds(c.sensor.reading_timeout));
      !ok) {
    return ok;
  }
  if (auto ok = check_positive("dwell.tolerance", c.dwell.tolerance); !ok) return ok;
  for (std::size_t i = 0; i < c.resolution.size(); ++i) {
    if (c.dwell.tolerance < c.resolution[i]) {
      return refused("dwell.tolerance", Error::kToleranceTooFine, i, c.dwell.tolerance,
                     c.resolution[i]);
    }
  }
  if (auto ok = check_positive("dwell.settle", hal::seconds(c.dwell.settle)); !ok) return ok;
  if (auto ok = check_positive("dwell.settle_timeout", hal::seconds(c.dwell.settle_timeout)); !ok) {
    return ok;
  }
  if (auto ok = check_count("dwell.pings", c.dwell.pings, 1, measurement::kMaxPings); !ok) {
    return ok;
  }
  return check_count("dwell.most_pings", c.dwell.most_pings, c.dwell.pings, measurement::kMaxPings);
}

Checked check_sweeps(const Configuration& c) {
  const SweepPlan& plan = c.sweeps;
  if (auto ok = check_readings("sweeps.configuration", plan.configuration, c.drawing); !ok) {
    return ok;
  }
  if (auto ok = check_positive("sweeps.arc", plan.arc_rad); !ok) return ok;
  if (plan.arc_rad > 2 * kPi) {
    return refused("sweeps.arc", Error::kOutOfRange, {}, plan.arc_rad, 2 * kPi);
  }
  if (auto ok = check_count("sweeps.points", plan.points, 6, plan.most_points); !ok) return ok;
  if (auto ok = check_count("sweeps.most_points", plan.most_points, 6, kMostSweepPoints); !ok) {
    return ok;
  }
  if (auto ok = check_positive("sweeps.axis_sigma", plan.axis_sigma_rad); !ok) return ok;
  if (auto ok = check_positive("sweeps.point_sigma", plan.point_sigma_m); !ok) return ok;
  if (auto ok = check_positive("sweeps.held_out_reach", plan.held_out_reach); !ok) return ok;
  if (plan.held_out_reach > 1) {
    return refused("sweeps.held_out_reach", Error::kOutOfRange, {}, plan.held_out_reach, 1);
  }
  return check_count("sweeps.held_out_poses", plan.held_out_poses, 3, kMostHeldOut);
}

Checked check_grid(const Configuration& c) {
  if (c.grid.taught[0].empty()) return {};
  for (const JointVector& q : c.grid.taught) {
    if (auto ok = check_readings("grid.taught", q, c.drawing); !ok) return ok;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (auto ok = check_positive("grid.size", c.grid.grid.size_m[axis]); !ok) return ok;
    if (auto ok = check_count("grid.count", c.grid.grid.count[axis], 2, evaluation::kMaxVertices);
        !ok) {
      return ok;
    }
  }
  return check_count("grid.count", c.grid.grid.vertex_count(), 8, evaluation::kMaxVertices);
}

}  // namespace

Checked check(const Configuration& configuration) {
  for (const auto part : {check_motion, check_measuring, check_sweeps, check_grid}) {
    if (auto arm = check_arm(configuration.drawing); !arm) return arm;
    if (auto checked = part(configuration); !checked) return checked;
  }
  return {};
}

}  // namespace armsig::controller
