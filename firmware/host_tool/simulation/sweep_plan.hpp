// SPDX-License-Identifier: MIT
// Which readings each joint is swept through, where the others are held, and how long that takes on
// an arm.
#pragma once

#include <cstddef>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::tool {

// Readings first, first + step, ... of one joint.
struct SweepOfJoint {
  double first = 0;
  double step = 0;
  std::size_t points = 0;

  [[nodiscard]] double reading(std::size_t k) const {
    return first + step * static_cast<double>(k);
  }
  [[nodiscard]] double last() const { return reading(points - 1); }
};

struct SweepPlan {
  JointVector configuration;  // the signature configuration
  FixedVector<SweepOfJoint, kMaxJoints> sweeps;
};

// The middle of each joint's limits.
[[nodiscard]] JointVector middle_of_limits(const Arm& arm);

// Every revolute joint through `arc_rad`, a turn at most, about the configuration, moved or cut
// where a limit stands in the way; every prismatic joint through its whole stroke. Preconditions:
// points >= 2, one configuration reading per joint.
[[nodiscard]] SweepPlan plan_sweeps(const Arm& arm, const JointVector& configuration,
                                    double arc_rad, std::size_t points);

// How an arm is assumed to move while it is measured.
struct SweepPace {
  double joint_speed_rad_s = radians(30);
  double slide_speed_m_s = 0.1;
  double settle_s = 0.4;  // until the target is at rest
  double ping_s = 0.05;   // one ultrasonic ping, echoes died away
  std::size_t pings = 1;  // a point
};

// Seconds for all sweeps, moves to the first reading and back to the signature configuration
// included.
[[nodiscard]] double duration_s(const Arm& arm, const SweepPlan& plan, const SweepPace& pace);

}  // namespace armsig::tool
