// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include "core/base/pose.hpp"
#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using tool::Dimension;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

Read<Pose> read_base(const YamlNode& node) {
  std::vector<std::string> known;
  for (const char* axis : {"x", "y", "z"}) tool::add_names(known, axis, Dimension::kLength);
  for (const char* angle : {"rx", "ry", "rz"}) tool::add_names(known, angle, Dimension::kAngle);
  ARMSIG_TRY(map, YamlMap::open(node, "base", known));
  Pose X_S0;
  ARMSIG_TRY(x_m, map.quantity("x", Dimension::kLength));
  ARMSIG_TRY(y_m, map.quantity("y", Dimension::kLength));
  ARMSIG_TRY(z_m, map.quantity("z", Dimension::kLength));
  X_S0.p = {x_m, y_m, z_m};
  double rx_rad = 0;
  double ry_rad = 0;
  double rz_rad = 0;
  Settings settings(map);
  settings.quantity("rx", Dimension::kAngle, rx_rad, false)
      .quantity("ry", Dimension::kAngle, ry_rad, false)
      .quantity("rz", Dimension::kAngle, rz_rad, false);
  settings.bound("x", Dimension::kLength, x_m, controller::plausible::kWorkspace)
      .bound("y", Dimension::kLength, y_m, controller::plausible::kWorkspace)
      .bound("z", Dimension::kLength, z_m, controller::plausible::kWorkspace);
  if (auto done = settings.done(); !done) return std::unexpected(done.error());
  X_S0.R = rotation_z(rz_rad) * rotation_about(Vector3::UnitY(), ry_rad) * rotation_x(rx_rad);
  return X_S0;
}

}  // namespace

Read<void> read_virtual(const YamlNode& node, DaemonConfiguration& c) {
  ARMSIG_TRY(map, YamlMap::open(node, "virtual", {"base"}));
  ARMSIG_TRY(base, map.require("base"));
  ARMSIG_TRY(X_S0, read_base(*base));
  c.virtual_base = X_S0;
  return {};
}

}  // namespace armsig::daemon
