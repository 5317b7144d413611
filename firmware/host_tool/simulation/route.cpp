// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/route.hpp"

namespace armsig::tool {

std::vector<Stop> route_by_home(const Arm& arm, const clearance::Surroundings& around,
                                const JointVector& home, std::span<const JointVector> poses) {
  std::vector<Stop> route{{.readings = home, .measured = false}};
  for (const JointVector& pose : poses) {
    clearance::WayLook look;
    const auto says = look.whole(arm.joints, around, effective_readings(arm, route.back().readings),
                                 effective_readings(arm, pose));
    if (says != clearance::WayLook::Says::kClear && route.back().measured) {
      route.push_back({.readings = home, .measured = false});
    }
    route.push_back({.readings = pose});
  }
  return route;
}

}  // namespace armsig::tool
