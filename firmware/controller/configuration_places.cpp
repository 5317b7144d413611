// SPDX-License-Identifier: MIT
// Where a configuration lets the arm be: in its workspace box, and at the corners of a grid.
#include <array>
#include <utility>

#include "core/kinematics/forward.hpp"
#include "firmware/controller/configuration_checks.hpp"
#include "firmware/controller/sweep.hpp"
#include "firmware/controller/workspace.hpp"

namespace armsig::controller {
namespace {

Checked check_box(const WorkspaceBox& box) {
  constexpr std::array<std::string_view, 3> kSides{"workspace.x", "workspace.y", "workspace.z"};
  for (std::size_t axis = 0; axis < kSides.size(); ++axis) {
    const double lower = box.lower[static_cast<Eigen::Index>(axis)];
    const double upper = box.upper[static_cast<Eigen::Index>(axis)];
    for (const double side : {lower, upper}) {
      if (auto ok = check_plausible(kSides[axis], side, plausible::kWorkspace); !ok) return ok;
    }
    if (!(lower < upper)) return refused(kSides[axis], Error::kLimitsReversed, {}, lower, upper);
  }
  return check_plausible("workspace.hand", box.hand_m, plausible::kHand);
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
  if (!c.workspace) return {};
  if (auto ok = check_box(*c.workspace); !ok) return ok;
  const JointVector& home = c.sweeps.configuration;
  const Room room = room_at(c, home);
  if (room.left_m < kLeastRoom_m) {
    return std::unexpected(
        ConfigurationRefusal{.setting = "workspace",
                             .error = Error::kOutsideWorkspace,
                             .joint = room.joint,
                             .found = room.left_m,
                             .needed = kLeastRoom_m,
                             .reason = "room between box and signature configuration"});
  }
  for (std::size_t i = 0; i < home.size(); ++i) {
    const JointLimits arc = planned_arc(c, i);
    for (const double end : {arc.lower, arc.upper}) {
      JointVector to = home;
      to[i] = end;
      WayLook look;
      while (look.step(c, home, to) == WayLook::Says::kMore) {
      }
      if (look.part() >= 1) continue;
      return std::unexpected(ConfigurationRefusal{
          .setting = "workspace",
          .error = Error::kOutsideWorkspace,
          .joint = i,
          .found = end,
          .needed = home[i] + look.part() * (end - home[i]),
          .reason = "about how far its sweep may go: a larger box, or a shorter sweeps.arc"});
    }
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
