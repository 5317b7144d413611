// SPDX-License-Identifier: MIT
#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/base/pose.hpp"
#include "firmware/controller/plausibility.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/sensor_parts.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using tool::Dimension;
using tool::problem_at;
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

Read<cabinet::EmulatedSocket> read_socket(const YamlNode& node) {
  std::vector<std::string> known = point_keys();
  known.emplace_back("place");
  ARMSIG_TRY(map, YamlMap::open(node, "a socket", known));
  ARMSIG_TRY(place, map.text("place"));
  if (!is_place_name(place)) {
    return problem_at(*map.find("place"), "place: " + tool::in_quotes(place),
                      std::string(kPlaceExpected));
  }
  ARMSIG_TRY(p_0, read_point(map, controller::plausible::kWorkspace));
  cabinet::EmulatedSocket socket{.place = {}, .p_0 = p_0};
  for (const char c : place) socket.place.push_back(c);
  return socket;
}

// `sockets`, `ball` and `seat_sigma_mm`.
Read<void> read_sockets(const YamlMap& map, const YamlNode& list, cabinet::EmulatedSockets& into) {
  ARMSIG_TRY(ball, map.require("ball"));
  ARMSIG_TRY(ball_map, YamlMap::open(*ball, "ball", point_keys()));
  ARMSIG_TRY(ball_F, read_point(ball_map, controller::plausible::kEmitter));
  into.ball_F = ball_F;
  ARMSIG_TRY(items, tool::read_list(list, "sockets", 1, into.all.capacity()));
  for (const YamlNode& item : *items) {
    ARMSIG_TRY(socket, read_socket(item));
    if (std::ranges::count(into.all, socket.name(), &cabinet::EmulatedSocket::name) != 0) {
      return problem_at(item, fmt::format("place: {} twice", socket.name()),
                        "each socket under a name of its own");
    }
    into.all.push_back(socket);
  }
  return Settings(map)
      .quantity("seat_sigma", Dimension::kLength, into.seat_sigma_m)
      .bound("seat_sigma", Dimension::kLength, into.seat_sigma_m,
             controller::plausible::kInstrumentSigma)
      .done();
}

}  // namespace

Read<void> read_virtual(const YamlNode& node, DaemonConfiguration& c) {
  std::vector<std::string> known{"base", "ball", "sockets"};
  tool::add_names(known, "seat_sigma", Dimension::kLength);
  ARMSIG_TRY(map, YamlMap::open(node, "virtual", known));
  const YamlNode* const sockets = map.find("sockets");
  if (sockets == nullptr) {
    ARMSIG_TRY(base, map.require("base"));
    ARMSIG_TRY(X_S0, read_base(*base));
    c.virtual_base = X_S0;
    for (const YamlNode& key : node.keys) {
      if (key.text == "base") continue;
      return problem_at(key, key.text + " without sockets", "sockets, or no such key");
    }
    return {};
  }
  if (const YamlNode* const base = map.find("base")) {
    ARMSIG_TRY(X_S0, read_base(*base));
    c.virtual_base = X_S0;
  }
  return read_sockets(map, *sockets, c.virtual_sockets);
}

}  // namespace armsig::daemon
