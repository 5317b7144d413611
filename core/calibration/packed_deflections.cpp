// SPDX-License-Identifier: MIT
#include "core/calibration/packed_deflections.hpp"

#include <algorithm>
#include <cmath>

namespace armsig::calibration {

namespace {

constexpr double kFullStep = 32767;

PackedMap packed(const JointModel& joint) {
  PackedMap map;
  map.domain = joint.domain;
  double largest = 0;
  for (const double value : joint.map) largest = std::max(largest, std::abs(value));
  if (largest == 0) return map;
  map.step = map_unit(joint.type) * largest / kFullStep;
  for (std::size_t k = 0; k < kKnots; ++k) {
    map.steps[k] = static_cast<std::int16_t>(std::lround(joint.map[k] / largest * kFullStep));
  }
  return map;
}

}  // namespace

PackedDeflections packed(const ArmModel& model) {
  PackedDeflections deflections;
  for (std::size_t i = 0; i < model.joint_count(); ++i) {
    deflections.maps.push_back(packed(model.joints[i]));
    deflections.drawn_zero[i] = model.joints[i].offset;
  }
  deflections.gravity = model.gravity;
  deflections.up_0 = model.up_0;
  return deflections;
}

ArmModel unpacked(const PackedDeflections& deflections, const Arm& drawing) {
  ArmModel model = model_of(drawing, {});
  for (std::size_t i = 0; i < deflections.maps.size(); ++i) {
    const PackedMap& map = deflections.maps[i];
    JointModel& joint = model.joints[i];
    joint.offset = deflections.drawn_zero[i];
    joint.domain = map.domain;
    for (std::size_t k = 0; k < kKnots; ++k) {
      joint.map[k] = map.step * map.steps[k] / map_unit(joint.type);
    }
  }
  model.gravity = deflections.gravity;
  model.up_0 = deflections.up_0;
  return model;
}

bool is_bounded(const PackedMap& map) {
  // Written so that a NaN is not bounded.
  if (!(std::abs(map.domain.origin) <= 1e6 && map.domain.per_length >= 0 &&
        map.domain.per_length <= 1e5 && map.step >= 0)) {
    return false;
  }
  for (std::size_t k = 0; k < kKnots; ++k) {
    const double value = map.steps[k];
    const double rise = map.steps[(k + 1) % kKnots] - value;
    if (!(map.step * std::abs(value) <= kLargestDeflection &&
          map.step * std::abs(rise) * map.domain.per_length <= kSteepestMap)) {
      return false;
    }
  }
  return true;
}

double longest_lever_m(const Arm& nominal) {
  constexpr double kLongestArm_m = 10;
  double length = 0;
  for (std::size_t i = 0; i < nominal.joints.size(); ++i) {
    const DhJoint& row = nominal.joints[i];
    length += std::hypot(row.a_m, row.d_m);
    if (row.type == JointType::kPrismatic && !nominal.limits.empty()) {
      length += std::max(std::abs(nominal.limits[i].lower), std::abs(nominal.limits[i].upper));
    }
  }
  return std::min(length, kLongestArm_m);
}

bool is_bounded(const GravityTerm& term, const Arm& nominal) {
  const std::size_t joints = nominal.joints.size();
  return term.joint < joints && term.origin > term.joint && term.origin <= joints &&
         std::abs(term.coefficient) * longest_lever_m(nominal) <= kLargestDeflection;
}

Result<void> check(const PackedDeflections& deflections, const Arm& nominal) {
  if (deflections.empty()) return {};
  const std::size_t joints = nominal.joints.size();
  bool good =
      deflections.maps.size() == joints && std::abs(deflections.up_0.squaredNorm() - 1) <= 2e-9;
  for (const PackedMap& map : deflections.maps) good = good && is_bounded(map);
  for (const GravityTerm& term : deflections.gravity) good = good && is_bounded(term, nominal);
  for (std::size_t i = 0; i < joints; ++i) {
    good = good && std::abs(deflections.drawn_zero[i]) <= 1e6;
  }
  if (!good) return std::unexpected(Error::kOutOfRange);
  return {};
}

}  // namespace armsig::calibration
