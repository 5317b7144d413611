// SPDX-License-Identifier: MIT
// Where a configuration lets the arm be: clear of what is around it, and at the corners of a grid.
#include <algorithm>
#include <array>
#include <utility>

#include "core/kinematics/forward.hpp"
#include "firmware/controller/configuration_checks.hpp"
#include "firmware/controller/sweep.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {
namespace {

Checked check_box(const clearance::Surroundings& around) {
  if (!around.has_box()) return {};
  constexpr std::array<std::string_view, 3> kSides{"workspace.x", "workspace.y", "workspace.z"};
  for (std::size_t axis = 0; axis < kSides.size(); ++axis) {
    const double lower = around.lower_B[static_cast<Eigen::Index>(axis)];
    const double upper = around.upper_B[static_cast<Eigen::Index>(axis)];
    for (const double side : {lower, upper}) {
      if (auto ok = check_plausible(kSides[axis], side, plausible::kWorkspace); !ok) return ok;
    }
    if (!(lower < upper)) return refused(kSides[axis], Error::kLimitsReversed, {}, lower, upper);
  }
  return {};
}

Checked too_near(const Configuration& c, std::string_view setting, const clearance::Room& room,
                 std::string_view reason) {
  return std::unexpected(ConfigurationRefusal{.setting = setting,
                                              .error = Error::kOutsideWorkspace,
                                              .joint = moving_joint(c, room),
                                              .found = room.left_m,
                                              .needed = kLeastRoom_m,
                                              .reason = reason,
                                              .room = room});
}

// The planned sweep of a joint: clear, and of an arc that says something of its axis.
Checked check_sweep(const Configuration& c, std::size_t joint) {
  const JointVector& home = c.sweeps.configuration;
  const JointLimits arc = planned_arc(c, joint);
  for (const double end : {arc.lower, arc.upper}) {
    JointVector to = home;
    to[joint] = end;
    WayLook look;
    const auto says = look.whole(c.drawing.joints, c.around, home, to);
    if (says == WayLook::Says::kClear) continue;
    return std::unexpected(ConfigurationRefusal{
        .setting = "workspace",
        .error = Error::kOutsideWorkspace,
        .joint = joint,
        .found = end,
        .needed = home[joint] + look.part() * (end - home[joint]),
        .reason = "about how far its sweep may go: a larger box, or a shorter arc",
        .room = look.room()});
  }
  // Less says too little of an axis, unless it is what was asked for.
  constexpr double kLeastArc_rad = radians(30);
  const double least = std::min(kLeastArc_rad, arc_of(c.sweeps, joint));
  const bool turns = c.drawing.joints[joint].type == JointType::kRevolute;
  if (!turns || arc.upper - arc.lower > least * (1 - 1e-9)) return {};
  return std::unexpected(ConfigurationRefusal{
      .setting = "sweeps.configuration",
      .error = Error::kOutsideWorkspace,
      .joint = joint,
      .found = arc.upper - arc.lower,
      .needed = least,
      .reason = "arc that what is around the arm leaves of its sweep: sweep_at elsewhere, or a "
                "larger box"});
}

// Three corners at different places, not in a line, make a workspace. Where the tool is out of the
// last frame's origin two corners may share that: then only the orientations tell them apart.
Checked check_taught(const Configuration& c) {
  const auto refuse = [](double distance_m) -> Checked {
    return std::unexpected(ConfigurationRefusal{
        .setting = "grid.taught",
        .error = Error::kCoincidentPoints,
        .joint = {},
        .found = distance_m,
        .needed = plausible::kLeastTaughtDistance_m,
        .reason = "origin, x axis and xy plane are taught at three places, not in a line"});
  };
  const kinematics::Chain chain = kinematics::make_chain(c.drawing.joints);
  std::array<Pose, 3> X_RT;
  for (std::size_t i = 0; i < X_RT.size(); ++i) {
    const auto pose = kinematics::forward(chain, c.grid.taught[i]);
    if (!pose) return refused("grid.taught", pose.error());
    X_RT[i] = *pose;
  }
  for (const auto& [a, b] : {std::pair(0U, 1U), std::pair(1U, 2U), std::pair(2U, 0U)}) {
    const double distance_m = (X_RT[a].p - X_RT[b].p).norm();
    const bool turned = angle_between(X_RT[a].R, X_RT[b].R) > 1e-2;
    if (distance_m < plausible::kLeastTaughtDistance_m && !turned) return refuse(distance_m);
  }
  const Vector3 along = X_RT[1].p - X_RT[0].p;
  if (along.norm() < plausible::kLeastTaughtDistance_m) return {};
  const double off_m = along.cross(X_RT[2].p - X_RT[0].p).norm() / along.norm();
  if (off_m < plausible::kLeastTaughtDistance_m) return refuse(off_m);
  return {};
}

}  // namespace

Checked check_workspace(const Configuration& c) {
  if (auto ok = check_box(c.around); !ok) return ok;
  if (auto ok = check_plausible("workspace.hand", c.around.hand_m, plausible::kHand); !ok)
    return ok;
  if (!kMayBound || c.around.are_empty()) return {};
  const clearance::Room room = room_at(c, c.sweeps.configuration);
  if (room.left_m < kLeastRoom_m) {
    return too_near(c, "workspace", room, "room around the arm in the signature configuration");
  }
  for (std::size_t i = 0; i < c.sweeps.configuration.size(); ++i) {
    if (auto ok = check_sweep(c, i); !ok) return ok;
  }
  return {};
}

Checked check_grid(const Configuration& c) {
  if (c.grid.taught[0].empty()) return {};
  for (const JointVector& q : c.grid.taught) {
    if (auto ok = check_readings("grid.taught", q, c.drawing); !ok) return ok;
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    auto size = check_plausible("grid.size", c.grid.grid.size_m[axis], plausible::kGridSize);
    if (!size) return size;
    if (auto ok = check_count("grid.count", c.grid.grid.count[axis], 2, evaluation::kMaxVertices);
        !ok) {
      return ok;
    }
  }
  auto dwell = check_plausible("grid.dwell", hal::seconds(c.grid.dwell), plausible::kGridDwell);
  if (!dwell) return dwell;
  if (auto ok = check_taught(c); !ok) return ok;
  return check_count("grid.count", c.grid.grid.vertex_count(), 8, evaluation::kMaxVertices);
}

}  // namespace armsig::controller
