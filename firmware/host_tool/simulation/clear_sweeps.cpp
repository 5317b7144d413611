// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/clear_sweeps.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/check.hpp"
#include "firmware/formats/mounting.hpp"

namespace armsig::tool {
namespace {

using clearance::Surroundings;
using clearance::WayLook;

// What stops joint `joint` on its way from `from` to `reading`; empty: nothing does.
std::string obstacle(const Arm& arm, const Surroundings& around, const JointVector& from,
                     std::size_t joint, double reading) {
  JointVector to = from;
  to[joint] = reading;
  WayLook look;
  const bool clear = look.whole(arm.joints, around, effective_readings(arm, from),
                                effective_readings(arm, to)) == WayLook::Says::kClear;
  return clear ? "" : limit_in_words(look.room(), arm.joints.size());
}

// "link 2 and the box" on one side or the other, or the joint limits.
std::string stopped_by(const Arm& arm, const Surroundings& around, const JointVector& from,
                       std::size_t joint, const JointLimits& limits) {
  const std::string below = obstacle(arm, around, from, joint, limits.lower);
  const std::string above = obstacle(arm, around, from, joint, limits.upper);
  if (below.empty() && above.empty()) return "its limits are that narrow";
  const std::string both = below.empty() || below == above ? above : below;
  const bool differ = !below.empty() && !above.empty() && below != above;
  return fmt::format("{}{} would meet", both, differ ? ", or " + above + "," : std::string());
}

}  // namespace

Read<void> check_configuration(const Arm& arm, const Surroundings& around,
                               const JointVector& configuration) {
  const clearance::Room room =
      clearance::room_at(arm.joints, around, effective_readings(arm, configuration));
  if (room.left_m >= clearance::kLeastRoom_m) return {};
  return std::unexpected(
      Problem{"--configuration", 0, 0, room_in_words(room, arm.joints.size()),
              fmt::format("{:g} mm of room: another --configuration, or, in the arm description, "
                          "where its floor is and how thick its links are",
                          1e3 * clearance::kLeastRoom_m)});
}

Read<SweepPlan> clear_sweeps(const Arm& arm, const Surroundings& around,
                             const JointVector& configuration, const JointVector& arcs_rad,
                             std::size_t points) {
  ARMSIG_CHECK(points >= 2 && configuration.size() == arm.joints.size());
  ARMSIG_CHECK(arcs_rad.size() == arm.joints.size());
  if (auto ok = check_configuration(arm, around, configuration); !ok) {
    return std::unexpected(std::move(ok).error());
  }
  SweepPlan plan{.configuration = configuration, .sweeps = {}};
  for (std::size_t j = 0; j < arm.joints.size(); ++j) {
    const bool turns = arm.joints[j].type == JointType::kRevolute;
    const double arc = std::min(arcs_rad[j], 2 * kPi);
    JointLimits limits = arm.limits[j];
    if (turns) {
      limits = {std::max(limits.lower, configuration[j] - arc),
                std::min(limits.upper, configuration[j] + arc)};
    }
    auto [lower, upper] =
        clearance::free_readings(arm.joints, arm.couplings, around, configuration, j, limits);
    if (upper - lower < (turns ? kLeastArc_rad : kLeastStroke_m)) {
      const double unit = turns ? degrees(1) : 1e3;
      return std::unexpected(Problem{
          "--configuration", 0, 0,
          fmt::format("joint {} sweeps {:.0f} {}: {}", j + 1, unit * (upper - lower),
                      turns ? "degrees" : "mm", stopped_by(arm, around, configuration, j, limits)),
          fmt::format("{:.0f} at least: another --configuration, or a larger box",
                      unit * (turns ? kLeastArc_rad : kLeastStroke_m))});
    }
    if (turns && arc < upper - lower) {
      lower = std::clamp(configuration[j] - arc / 2, lower, upper - arc);
      upper = lower + arc;
    }
    plan.sweeps.push_back({.first = lower,
                           .step = (upper - lower) / static_cast<double>(points - 1),
                           .points = points});
  }
  return plan;
}

}  // namespace armsig::tool
