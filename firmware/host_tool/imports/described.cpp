// SPDX-License-Identifier: MIT
#include <utility>

#include "firmware/host_tool/imports/import.hpp"

namespace armsig::tool {

ImportedArm described(const AxisChain& chain, std::string name,
                      std::vector<std::string> joint_names) {
  DrawnChain drawing = drawn(chain);
  ImportedArm imported{{.name = std::move(name),
                        .arm = std::move(drawing.arm),
                        .joint_names = std::move(joint_names)},
                       std::move(drawing.notes)};
  constexpr double kUpright = 1e-9;
  const Vector3& up_0 = imported.description.arm.up_0;
  if (up_0.head<2>().norm() > kUpright) {
    imported.description.mounting.on = clearance::Mounting::On::kTilted;
    imported.description.mounting.tilted_gravity_B = -up_0;
  }
  return imported;
}

}  // namespace armsig::tool
