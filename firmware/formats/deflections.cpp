// SPDX-License-Identifier: MIT
#include "firmware/formats/deflections.hpp"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/calibration/packed_deflections.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

using calibration::ArmModel;
using calibration::GravityTerm;
using calibration::JointModel;
using calibration::kKnots;
using calibration::kLargestDeflection;
using calibration::kSteepestMap;

template <typename Values>
std::string row_text(const Values& values) {
  std::string text = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ", ";
    text += number_text(static_cast<double>(values[i]));
  }
  return text + "]";
}

Read<void> read_gravity(const YamlNode& node, const Arm& nominal, ArmModel& model) {
  ARMSIG_TRY(list, read_list(node, "gravity", 0, calibration::kMaxGravityTerms));
  const auto n = static_cast<double>(model.joint_count());
  const double lever_m = calibration::longest_lever_m(nominal);
  for (const YamlNode& item : *list) {
    ARMSIG_TRY(term, read_numbers(item, "a gravity term", 3));
    const bool known = term[0] >= 1 && term[0] <= n && term[1] > term[0] - 1 && term[1] <= n &&
                       std::floor(term[0]) == term[0] && std::floor(term[1]) == term[1];
    if (!known || !(std::abs(term[2]) * lever_m <= kLargestDeflection)) {
      return problem_at(item, fmt::format("a gravity term {}, {}, {}", term[0], term[1], term[2]),
                        fmt::format("a joint, a link beyond it, and at most {:.3g} rad or m per m",
                                    kLargestDeflection / lever_m));
    }
    model.gravity.push_back(
        {static_cast<std::uint8_t>(term[0] - 1), static_cast<std::uint8_t>(term[1]), term[2]});
  }
  return {};
}

// No map may turn a joint far, or move it fast against its reading.
Read<void> check_map(const YamlNode& node, const JointModel& joint) {
  const double unit = calibration::map_unit(joint.type);
  for (std::size_t k = 0; k < kKnots; ++k) {
    const double value = joint.map[k];
    const double rise = joint.map[(k + 1) % kKnots] - value;
    if (std::abs(unit * value) <= kLargestDeflection &&
        std::abs(unit * rise * joint.domain.per_length) <= kSteepestMap &&
        joint.map_variance[k] >= 0) {
      continue;
    }
    return problem_at(node, fmt::format("a map that jumps at value {}", k + 1),
                      "values of a smooth map, and variances that are not negative");
  }
  return {};
}

Read<void> read_map(const YamlNode& node, std::size_t index, JointModel& joint) {
  ARMSIG_TRY(map, YamlMap::open(node, fmt::format("map {}", index + 1),
                                {"origin", "per_length", "values", "variances", "covered"}));
  ARMSIG_TRY(origin, map.number("origin"));
  ARMSIG_TRY(per_length, map.number("per_length"));
  ARMSIG_TRY(values_node, map.require("values"));
  ARMSIG_TRY(values, read_numbers(*values_node, "values", kKnots));
  ARMSIG_TRY(variances_node, map.require("variances"));
  ARMSIG_TRY(variances, read_numbers(*variances_node, "variances", kKnots));
  joint.domain = {origin, per_length};
  if (const YamlNode* covered_node = map.find("covered"); covered_node != nullptr) {
    ARMSIG_TRY(covered, read_numbers(*covered_node, "covered", 2));
    if (covered[0] > covered[1]) {
      return problem_at(*covered_node, fmt::format("covered {}, {}", covered[0], covered[1]),
                        "the lowest and the highest reading, in this order");
    }
    joint.covered = {covered[0], covered[1]};
  }
  for (std::size_t k = 0; k < kKnots; ++k) {
    joint.map[k] = values[k];
    joint.map_variance[k] = static_cast<float>(variances[k]);
  }
  return check_map(node, joint);
}

}  // namespace

std::string deflections_text(const SignatureRecord& record) {
  if (!record.deflections) return "";
  const ArmModel& model = *record.deflections;
  std::string text =
      "deflections:  # beyond geometry: gravity, and a map of each reading (docs/formats.md)\n";
  std::vector<double> zeros;
  for (const JointModel& joint : model.joints) zeros.push_back(joint.offset);
  text += fmt::format("  drawn_zero: {}\n", row_text(zeros));
  text += fmt::format("  up: {}\n",
                      row_text(std::array{model.up_0.x(), model.up_0.y(), model.up_0.z()}));
  text += model.gravity.empty() ? "  gravity: []\n" : "  gravity:\n";
  for (const GravityTerm& term : model.gravity) {
    text += fmt::format("    - [{}, {}, {}]\n", term.joint + 1, term.origin,
                        number_text(term.coefficient));
  }
  text += "  maps:\n";
  for (const JointModel& joint : model.joints) {
    text += fmt::format("    - origin: {}\n      per_length: {}\n",
                        number_text(joint.domain.origin), number_text(joint.domain.per_length));
    text += fmt::format("      covered: {}\n",
                        row_text(std::array{joint.covered.lower, joint.covered.upper}));
    text += fmt::format("      values: {}\n      variances: {}\n", row_text(joint.map),
                        row_text(joint.map_variance));
  }
  return text;
}

Read<void> read_deflections(const YamlMap& root, SignatureRecord& record) {
  const YamlNode* node = root.find("deflections");
  if (node == nullptr) return {};
  ARMSIG_TRY(map, YamlMap::open(*node, "deflections", {"drawn_zero", "up", "gravity", "maps"}));
  auto model = std::make_shared<ArmModel>(calibration::model_of(record.nominal, {}));
  const std::size_t n = model->joint_count();
  ARMSIG_TRY(zeros_node, map.require("drawn_zero"));
  ARMSIG_TRY(zeros, read_numbers(*zeros_node, "drawn_zero", n));
  ARMSIG_TRY(maps_node, map.require("maps"));
  ARMSIG_TRY(maps, read_list(*maps_node, "maps", n, n));
  for (std::size_t i = 0; i < n; ++i) {
    model->joints[i].offset = zeros[i];
    if (auto done = read_map((*maps)[i], i, model->joints[i]); !done) return done;
  }
  ARMSIG_TRY(gravity_node, map.require("gravity"));
  if (auto done = read_gravity(*gravity_node, record.nominal, *model); !done) return done;
  ARMSIG_TRY(up_0, map.vector3("up"));
  constexpr double kUnit = 1e-9;
  if (!(std::abs(up_0.norm() - 1) <= kUnit)) {
    return problem_at(*map.find("up"), fmt::format("up: a vector of length {}", up_0.norm()),
                      "a direction in frame 0, of length 1");
  }
  model->up_0 = up_0;
  record.deflections = std::move(model);
  return {};
}

}  // namespace armsig::tool
