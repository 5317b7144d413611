// SPDX-License-Identifier: MIT
#include <string>
#include <vector>

#include <fmt/format.h>

#include "core/evaluation/grid_touching.hpp"
#include "firmware/formats/yaml_map.hpp"
#include "firmware/linux/sections.hpp"
#include "firmware/linux/settings.hpp"

namespace armsig::daemon {
namespace {

using tool::add_names;
using tool::Dimension;
using tool::problem_at;
using tool::Read;
using tool::YamlMap;
using tool::YamlNode;

Read<JointVector> read_readings(const YamlNode& node, const std::string& name, const Arm& arm) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    add_names(known, fmt::format("q{}", i + 1), tool::dimension_of(arm.joints[i].type));
  }
  ARMSIG_TRY(map, YamlMap::open(node, name, known));
  JointVector q;
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    ARMSIG_TRY(reading,
               map.quantity(fmt::format("q{}", i + 1), tool::dimension_of(arm.joints[i].type)));
    q.push_back(reading);
  }
  return q;
}

// Corners found where the drawing reaches all of the grid.
Read<void> place(const YamlNode& node, DaemonConfiguration& c) {
  controller::GridTask& task = c.controller.grid;
  const Arm& arm = c.controller.drawing;
  const evaluation::ToolModel drawing{.chain = kinematics::make_chain(arm.joints, arm.limits),
                                      .p_nT = c.p_nT};
  const auto placed = evaluation::place_grid(drawing, task.grid);
  if (!placed) {
    return problem_at(node, std::string(describe(placed.error())),
                      "a grid that the arm reaches, or its corners");
  }
  task.grid = placed->grid;
  task.taught = placed->taught;
  return {};
}

}  // namespace

Read<void> read_grid(const YamlNode& node, DaemonConfiguration& c) {
  controller::GridTask& task = c.controller.grid;
  std::vector<std::string> known{"count", "corners"};
  add_names(known, "size", Dimension::kLength);
  add_names(known, "dwell", Dimension::kTime);
  ARMSIG_TRY(map, YamlMap::open(node, "the grid", known));
  ARMSIG_TRY(size, map.require_quantity("size", Dimension::kLength));
  ARMSIG_TRY(lengths, tool::read_numbers(*size.value, size.key->text, 3));
  ARMSIG_TRY(count, map.require("count"));
  ARMSIG_TRY(counts, tool::read_list(*count, "count", 3, 3));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(lengths[axis] > 0)) {
      return problem_at(*size.value, fmt::format("{}: {}", size.key->text, lengths[axis]),
                        "lengths above 0");
    }
    task.grid.size_m[axis] = size.unit.to_si(lengths[axis]);
    ARMSIG_TRY(vertices, tool::read_integer((*counts)[axis], "count", 2,
                                            static_cast<int>(evaluation::kMaxVertices)));
    task.grid.count[axis] = static_cast<std::size_t>(vertices);
  }
  if (task.grid.vertex_count() > evaluation::kMaxVertices) {
    return problem_at(*count, fmt::format("{} vertices", task.grid.vertex_count()),
                      fmt::format("at most {}", evaluation::kMaxVertices));
  }
  Settings settings(map);
  settings.time("dwell", task.dwell);
  if (auto done = settings.done(); !done) return done;
  ARMSIG_TRY(corners, map.require("corners"));
  if (corners->kind == YamlNode::Kind::kScalar && corners->text == "automatic") {
    return place(*corners, c);
  }
  ARMSIG_TRY(corner_map, YamlMap::open(*corners, "corners", {"origin", "on_x", "in_xy"}));
  std::size_t i = 0;
  for (const char* corner : {"origin", "on_x", "in_xy"}) {
    ARMSIG_TRY(readings, corner_map.require(corner));
    ARMSIG_TRY(q, read_readings(*readings, corner, c.controller.drawing));
    task.taught[i++] = q;
  }
  return {};
}

}  // namespace armsig::daemon
