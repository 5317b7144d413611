// SPDX-License-Identifier: MIT
#include "firmware/controller/workspace.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/links.hpp"

namespace armsig::controller {
namespace {

constexpr int kPlacesAStep = 6;

// Per origin of frames 1 ... n.
using Lengths = std::array<double, kMaxJoints>;

// Distances to the nearest side, of the last frame that of the whole hand.
Lengths rooms_at(const Configuration& configuration, const JointVector& q) {
  const DhRows& rows = configuration.drawing.joints;
  const WorkspaceBox& box = *configuration.workspace;
  Lengths rooms{};
  Pose X_0F;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    X_0F = X_0F * link_transform(rows[i], q[i]);
    rooms[i] = std::min((X_0F.p - box.lower).minCoeff(), (box.upper - X_0F.p).minCoeff());
  }
  rooms[rows.size() - 1] -= box.hand_m;
  return rooms;
}

// How far each can move at most on the way: every joint turns it by its change, about an axis that
// is no farther than the links between are long. The hand fills a ball about the last one, whose
// room changes by as much as its centre moves.
Lengths longest_ways(const Configuration& configuration, const JointVector& from,
                     const JointVector& to) {
  const DhRows& rows = configuration.drawing.joints;
  Lengths ways{};
  for (std::size_t joint = 0; joint < rows.size(); ++joint) {
    const double change = std::abs(to[joint] - from[joint]);
    const bool turns = rows[joint].type == JointType::kRevolute;
    double lever_m = std::abs(rows[joint].a_m);
    for (std::size_t i = joint; i < rows.size(); ++i) {
      if (i > joint) {
        const DhJoint& row = rows[i];
        const bool slides = row.type == JointType::kPrismatic;
        const double d_m = slides ? std::max(std::abs(row.d_m + from[i]), std::abs(row.d_m + to[i]))
                                  : std::abs(row.d_m);
        lever_m += std::hypot(row.a_m, d_m);
      }
      ways[i] += change * (turns ? lever_m : 1);
    }
  }
  return ways;
}

Room least_of(const Lengths& rooms, std::size_t joints) {
  const auto* const least = std::min_element(rooms.begin(), rooms.begin() + joints);
  return {*least, static_cast<std::size_t>(least - rooms.begin())};
}

}  // namespace

Room room_at(const Configuration& configuration, const JointVector& q) {
  return least_of(rooms_at(configuration, q), q.size());
}

WayLook::Says WayLook::step(const Configuration& configuration, const JointVector& from,
                            const JointVector& to) {
  if (!configuration.workspace) {
    part_ = 1;
    return Says::kClear;
  }
  const Lengths ways_m = longest_ways(configuration, from, to);
  for (int place = 0; place < kPlacesAStep; ++place) {
    JointVector q = from;
    for (std::size_t i = 0; i < q.size(); ++i) q[i] += part() * (to[i] - from[i]);
    const Lengths rooms_m = rooms_at(configuration, q);
    const Room least = least_of(rooms_m, q.size());
    if (least.left_m < kLeastRoom_m) {
      joint_ = static_cast<std::uint8_t>(least.joint);
      return Says::kLeaves;
    }
    double onward = 1;
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double on_m = rooms_m[i] - kLeastRoom_m / 2;
      if (ways_m[i] > on_m) onward = std::min(onward, on_m / ways_m[i]);
    }
    if (part() + onward >= 1) {
      part_ = 1;
      return Says::kClear;
    }
    part_ += static_cast<float>(onward);
  }
  return Says::kMore;
}

}  // namespace armsig::controller
