// SPDX-License-Identifier: MIT
#include "firmware/formats/mounting.hpp"

#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

using clearance::Limit;
using clearance::Mounting;

constexpr std::array<std::pair<std::string_view, Mounting::On>, 3> kPlaces{
    {{"floor", Mounting::On::kFloor},
     {"ceiling", Mounting::On::kCeiling},
     {"wall", Mounting::On::kWall}}};
constexpr std::string_view kMountedWays = "floor, ceiling, wall, or {gravity: [x, y, z]}";

Read<void> read_mounted(const YamlNode& node, Mounting& mounting) {
  if (node.kind == YamlNode::Kind::kScalar) {
    for (const auto& [word, on] : kPlaces) {
      if (node.text != word) continue;
      mounting.on = on;
      return {};
    }
    return problem_at(node, "mounted: " + in_quotes(node.text), std::string(kMountedWays));
  }
  ARMSIG_TRY(map, YamlMap::open(node, "mounted", {"gravity"}));
  ARMSIG_TRY(pull, map.vector3("gravity"));
  mounting.tilted_gravity_B = direction_of(pull);
  if (mounting.tilted_gravity_B.isZero(0)) {
    return problem_at(node, "gravity of no length", "which way it pulls, in the base frame");
  }
  mounting.on = Mounting::On::kTilted;
  return {};
}

Read<std::optional<double>> find_length(const YamlMap& map, std::string_view name) {
  constexpr double kLongest_m = 100;
  ARMSIG_TRY(found, map.find_quantity(name, Dimension::kLength));
  if (!found) return std::nullopt;
  ARMSIG_TRY(number, read_number(*found->value, found->key->text));
  const double length_m = found->unit.to_si(number);
  if (length_m >= 0 && length_m <= kLongest_m) return length_m;
  return problem_at(*found->value, fmt::format("{}: {:g}", found->key->text, number),
                    "a length from 0 to 100 m");
}

std::string number_in(double length_m, const LengthWords& words) {
  const double number = words.per_m * length_m;
  const double digit = words.per_m > 1 ? 1 : 1e-3;
  const double rounded = std::round(number / digit) * digit;
  return fmt::format("{:.{}f}", rounded == 0 ? 0.0 : rounded, words.per_m > 1 ? 0 : 3);
}

std::string link_in_words(std::size_t link, std::size_t joints) {
  return link > joints ? "what the flange carries" : fmt::format("link {}", link);
}

std::string_view limit_word(Limit limit) {
  switch (limit) {
    case Limit::kMountingPlane:
      return "the mounting plane";
    case Limit::kFloor:
      return "the floor";
    case Limit::kBox:
      return "the box";
    case Limit::kLink:
      break;
  }
  return "a link";
}

std::string limit_of(const clearance::Room& room) {
  return room.limit == Limit::kLink ? fmt::format("link {}", room.other)
                                    : std::string(limit_word(room.limit));
}

}  // namespace

void add_mounting_keys(std::vector<std::string>& known) {
  known.emplace_back("mounted");
  add_names(known, "floor", Dimension::kLength);
  add_names(known, "link_radius", Dimension::kLength);
}

Read<Mounting> read_mounting(const YamlMap& map) {
  Mounting mounting;
  if (const YamlNode* node = map.find("mounted")) {
    if (auto done = read_mounted(*node, mounting); !done) {
      return std::unexpected(std::move(done).error());
    }
  }
  ARMSIG_TRY(floor_m, find_length(map, "floor"));
  ARMSIG_TRY(link_radius_m, find_length(map, "link_radius"));
  mounting.floor_m = floor_m;
  mounting.link_radius_m = link_radius_m;
  return mounting;
}

std::string mounting_text(const Mounting& mounting) {
  std::string text;
  for (const auto& [word, on] : kPlaces) {
    if (on == mounting.on && on != Mounting::On::kFloor) text = fmt::format("mounted: {}\n", word);
  }
  if (mounting.on == Mounting::On::kTilted) {
    const Vector3& g_B = mounting.tilted_gravity_B;
    text = fmt::format("mounted: {{gravity: [{}, {}, {}]}}\n", number_text(g_B.x()),
                       number_text(g_B.y()), number_text(g_B.z()));
  }
  if (mounting.floor_m) text += fmt::format("floor_m: {}\n", number_text(*mounting.floor_m));
  if (mounting.link_radius_m) {
    text += fmt::format("link_radius_m: {}\n", number_text(*mounting.link_radius_m));
  }
  return text;
}

std::string limit_in_words(const clearance::Room& room, std::size_t joints) {
  return fmt::format("{} and {}", link_in_words(room.link, joints), limit_of(room));
}

std::string room_in_words(const clearance::Room& room, std::size_t joints,
                          const LengthWords& words) {
  const bool beyond = room.left_m < 0;
  return fmt::format("{} is {} {} {} {}; it ends at {}, {}, {} {} of the base frame",
                     link_in_words(room.link, joints), number_in(std::abs(room.left_m), words),
                     words.unit, beyond ? "beyond" : "from", limit_of(room),
                     number_in(room.p_B.x(), words), number_in(room.p_B.y(), words),
                     number_in(room.p_B.z(), words), words.unit);
}

std::string surroundings_in_words(const clearance::Surroundings& around, const LengthWords& words) {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  for (const clearance::HalfSpace& plane : around.planes) {
    if (plane.limit == Limit::kFloor) {
      add(fmt::format("no link below the floor, {} {} below the base",
                      number_in(-plane.offset_m, words), words.unit));
    } else {
      add("no link below the mounting plane, z = 0 of the base");
    }
  }
  if (around.has_box()) {
    std::string sides;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      sides += fmt::format("{}{} {} to {}", axis == 0 ? "" : ", ",
                           std::string_view("xyz").substr(static_cast<std::size_t>(axis), 1),
                           number_in(around.lower_B[axis], words),
                           number_in(around.upper_B[axis], words));
    }
    add(fmt::format("the whole arm in the box {} {}", sides, words.unit));
  }
  if (around.link_radius_m > 0) {
    add(fmt::format("links are {} {} in radius and stay clear of each other",
                    number_in(around.link_radius_m, words), words.unit));
  }
  if (around.hand_m > 0) {
    add(fmt::format("the flange carries what fills a ball of {} {}",
                    number_in(around.hand_m, words), words.unit));
  }
  return text.empty() ? "nothing is known around the arm" : text;
}

}  // namespace armsig::tool
