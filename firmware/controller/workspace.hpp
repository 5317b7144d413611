// SPDX-License-Identifier: MIT
// Where the controller looks at the way before the arm goes, and how it tells what is in it.
#pragma once

#include <algorithm>

#include "core/clearance/clearance.hpp"
#include "firmware/controller/configuration.hpp"
#include "firmware/controller/refinement.hpp"
#include "firmware/controller/text.hpp"

namespace armsig::controller {

using clearance::kLeastRoom_m;
using clearance::WayLook;

// The R5F has no memory to look at the way: a test looks at the sweeps, held-out poses and checks
// of its configuration (host_tests/r5f).
inline constexpr bool kMayBound = kMayRefine;

// A step of `look` at the way of a joint move, readings of the joints.
[[nodiscard]] inline WayLook::Says look_on(WayLook& look, const Configuration& configuration,
                                           const JointVector& from, const JointVector& to) {
  return look.step(configuration.drawing.joints, configuration.around, from, to);
}

[[nodiscard]] inline clearance::Room room_at(const Configuration& configuration,
                                             const JointVector& q, const JointVector& within = {}) {
  return clearance::room_at(configuration.drawing.joints, configuration.around, q, within);
}

// The joint that moves what is too near.
[[nodiscard]] inline std::size_t moving_joint(const Configuration& configuration,
                                              const clearance::Room& room) {
  return std::min<std::size_t>(room.link, configuration.drawing.joints.size()) - 1;
}

// How much room an operator's move asks for that begins where the arm is: where it has less there,
// it must not have less anywhere on the way.
[[nodiscard]] double asked_room_m(const Configuration& configuration, const JointVector& from);

// " link=4 near=floor room_mm=-12.0 x_mm=300.0 y_mm=0.0 z_mm=-12.0": what is too near to what; the
// place of the link's outer end in the base frame. near= mounting_plane, floor, box, or link_2. The
// link after the last is what the flange carries.
void add_room(Line& line, const clearance::Room& room);

}  // namespace armsig::controller
