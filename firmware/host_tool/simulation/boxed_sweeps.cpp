// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/boxed_sweeps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/links.hpp"

namespace armsig::tool {
namespace {

// The last frame of the drawing in its base.
Pose flange(const Arm& arm, const JointVector& readings) {
  return dh_frames(arm.joints, effective_readings(arm, readings)).back();
}

// How far joint `j` gets from `from` towards `to` before the target leaves the box.
double reach_towards(const Arm& arm, JointVector q, std::size_t j, double to, const ReachBox& box) {
  constexpr int kSteps = 720;  // a quarter of a degree for half a turn
  const double from = q[j];
  double reached = from;
  for (int k = 1; k <= kSteps; ++k) {
    q[j] = from + (to - from) * k / kSteps;
    if (!box.holds(arm, q)) break;
    reached = q[j];
  }
  return reached;
}

}  // namespace

bool ReachBox::holds(const Arm& arm, const JointVector& readings) const {
  const Vector3 p_BT = flange(arm, readings) * p_FT;
  return (p_BT.array() >= lower_B.array()).all() && (p_BT.array() <= upper_B.array()).all();
}

Read<SweepPlan> sweeps_inside(const Arm& arm, const JointVector& configuration, double arc_rad,
                              std::size_t points, const ReachBox& box) {
  if (!box.holds(arm, configuration)) {
    const Vector3 p_BT_mm = 1e3 * (flange(arm, configuration) * box.p_FT);
    const auto whole = [&](int axis) { return std::lround(p_BT_mm[axis]); };  // never -0
    return std::unexpected(
        Problem{"--box-mm", 0, 0,
                fmt::format("the target is at {}, {}, {} mm in the configuration, "
                            "outside of the box",
                            whole(0), whole(1), whole(2)),
                "--configuration with the target inside, or a larger box"});
  }
  SweepPlan plan = plan_sweeps(arm, configuration, arc_rad, points);
  for (std::size_t j = 0; j < plan.sweeps.size(); ++j) {
    SweepOfJoint& sweep = plan.sweeps[j];
    const double low =
        reach_towards(arm, configuration, j, std::min(sweep.first, sweep.last()), box);
    const double high =
        reach_towards(arm, configuration, j, std::max(sweep.first, sweep.last()), box);
    if (arm.joints[j].type == JointType::kRevolute && high - low < kLeastArc_rad) {
      return std::unexpected(
          Problem{"--box-mm", 0, 0,
                  fmt::format("joint {} sweeps {:.0f} degrees between its limits inside the box",
                              j + 1, degrees(high - low)),
                  fmt::format("{:.0f} at least: another --configuration, or a larger box",
                              degrees(kLeastArc_rad))});
    }
    sweep.first = low;
    sweep.step = (high - low) / static_cast<double>(sweep.points - 1);
  }
  return plan;
}

}  // namespace armsig::tool
