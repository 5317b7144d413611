// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/sweep_plan.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/joint_range.hpp"
#include "core/base/pose.hpp"

namespace armsig::tool {

JointVector middle_of_limits(const Arm& arm) {
  JointVector middle;
  for (const JointLimits& limits : arm.limits) middle.push_back(middle_of(limits));
  return middle;
}

SweepPlan plan_sweeps(const Arm& arm, const JointVector& configuration, double arc_rad,
                      std::size_t points) {
  ARMSIG_CHECK(points >= 2 && configuration.size() == arm.joints.size());
  SweepPlan plan{.configuration = configuration, .sweeps = {}};
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    auto [lower, upper] = arm.limits[j];
    const double arc = std::min(arc_rad, 2 * kPi);
    if (arm.joints[j].type == JointType::kRevolute && arc < upper - lower) {
      lower = std::clamp(configuration[j] - arc / 2, lower, upper - arc);
      upper = lower + arc;
    }
    plan.sweeps.push_back({.first = lower,
                           .step = (upper - lower) / static_cast<double>(points - 1),
                           .points = points});
  }
  return plan;
}

double duration_s(const Arm& arm, const SweepPlan& plan, const SweepPace& pace) {
  double total_s = 0;
  for (std::size_t j = 0; j < plan.sweeps.size(); ++j) {
    const SweepOfJoint& sweep = plan.sweeps[j];
    const double speed =
        arm.joints[j].type == JointType::kRevolute ? pace.joint_speed_rad_s : pace.slide_speed_m_s;
    const double travel = std::abs(sweep.first - plan.configuration[j]) +
                          std::abs(sweep.last() - sweep.first) +
                          std::abs(plan.configuration[j] - sweep.last());
    const double dwell_s = pace.settle_s + pace.ping_s * static_cast<double>(pace.pings);
    total_s += travel / speed + dwell_s * static_cast<double>(sweep.points);
  }
  return total_s;
}

}  // namespace armsig::tool
