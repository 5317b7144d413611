// SPDX-License-Identifier: MIT
#include "firmware/controller/workspace.hpp"

#include <algorithm>

#include "firmware/controller/sweep.hpp"

namespace armsig::controller {

void limit_sweeps(Configuration& c) {
  c.sweeps.free.clear();
  for (std::size_t joint = 0; joint < c.drawing.joints.size(); ++joint) {
    c.sweeps.free.push_back(clearance::free_readings(
        c.drawing.joints, {}, c.around, c.sweeps.configuration, joint, c.drawing.limits[joint]));
  }
}

double asked_room_m(const Configuration& configuration, const JointVector& from) {
  constexpr double kRounding_m = 1e-6;
  return std::min(kLeastRoom_m, room_at(configuration, from).left_m - kRounding_m);
}

void add_room(Line& line, const clearance::Room& room) {
  using enum clearance::Limit;
  line.text(" link=").integer(room.link).text(" near=");
  switch (room.limit) {
    case kMountingPlane:
      line.text("mounting_plane");
      break;
    case kFloor:
      line.text("floor");
      break;
    case kBox:
      line.text("box");
      break;
    case kLink:
      line.text("link_").integer(room.other);
      break;
  }
  line.text(" room_mm=").number(1e3 * room.left_m, 1);
  line.text(" x_mm=").number(1e3 * room.p_B.x(), 1);
  line.text(" y_mm=").number(1e3 * room.p_B.y(), 1);
  line.text(" z_mm=").number(1e3 * room.p_B.z(), 1);
}

}  // namespace armsig::controller
