// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/signature_comparison.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "core/identification.hpp"
#include "firmware/analysis/differences/differences.hpp"
#include "firmware/fleet/wire/signature_document.hpp"

namespace armsig::fleet {
namespace {

using calibration::ArmModel;
using calibration::GravityTerm;
using calibration::JointModel;

constexpr int kLooks = 720;  // along a map

double largest_change(const JointModel& before, const JointModel& now) {
  double largest = 0;
  for (const JointModel* of : {&before, &now}) {
    if (!(of->domain.per_length > 0)) continue;
    const double length = calibration::kKnots / of->domain.per_length;
    for (int i = 0; i < kLooks; ++i) {
      const double reading = of->domain.origin + length * i / kLooks;
      const auto value = [&](const JointModel& joint) {
        return joint.domain.per_length > 0 ? calibration::map_at(joint, reading) : 0;
      };
      largest = std::max(largest, std::abs(value(now) - value(before)));
    }
  }
  return largest;
}

double coefficient(const ArmModel& model, const GravityTerm& like) {
  double sum = 0;
  for (const GravityTerm& term : model.gravity) {
    if (term.joint == like.joint && term.origin == like.origin) sum += term.coefficient;
  }
  return sum;
}

void compare_bends(const ArmModel& former, const ArmModel& actual,
                   SignatureComparison& comparison) {
  for (std::size_t i = 0; i < comparison.joints.size(); ++i) {
    comparison.joints[i].map = largest_change(former.joints[i], actual.joints[i]);
  }
  for (const ArmModel* of : {&former, &actual}) {
    for (const GravityTerm& term : of->gravity) {
      double& largest = comparison.joints[term.joint].gravity;
      largest = std::max(largest, std::abs(coefficient(actual, term) - coefficient(former, term)));
    }
  }
}

// Whether it says by how much its joints give way: nothing, or from which readings on.
bool is_told(const DocumentedSignature& signature) {
  return signature.deflections.empty() || !signature.configuration.empty();
}

differences::Bending bending_of(const DocumentedSignature& signature, const ArmModel& model) {
  if (signature.deflections.empty()) return {};
  return {.model = &model, .configuration = signature.configuration};
}

bool same_joints(const Arm& a, const Arm& b) {
  return std::ranges::equal(a.joints, b.joints, {}, &DhJoint::type, &DhJoint::type);
}

}  // namespace

std::optional<SignatureComparison> compare_signatures(std::string_view before,
                                                      std::string_view now) {
  const auto former = read_signature_document(before);
  const auto actual = read_signature_document(now);
  if (!former || !actual || !same_joints(former->arm, actual->arm)) return std::nullopt;
  const std::size_t n = actual->arm.joints.size();
  // Too large for a stack. Without unknowns: exact.
  const auto exact = std::make_unique<calibration::Refined>();
  const KnownTarget tool{.number = 1, .link = n, .p_F = Vector3(0, 0, 0.1)};
  exact->signature = signature_of(actual->arm, JointVector(n), {}, std::span(&tool, 1));
  const auto bent_before = std::make_unique<ArmModel>(unpacked(former->deflections, former->arm));
  const auto bent_now = std::make_unique<ArmModel>(unpacked(actual->deflections, actual->arm));
  const bool whole = is_told(*former) && is_told(*actual);
  differences::Bendings bendings;
  if (whole) bendings = {bending_of(*former, *bent_before), bending_of(*actual, *bent_now)};
  const auto found = differences::differences(former->arm, *exact, 0, bendings);
  if (!found) return std::nullopt;
  SignatureComparison comparison{
      .joints = std::vector<JointDifference>(n),
      .tool_rms_m = found->total_rms_m,
      .bends = !former->deflections.empty() || !actual->deflections.empty(),
      .whole = whole};
  for (const differences::Difference& difference : found->all) {
    JointDifference& joint = comparison.joints[difference.joint];
    joint.adds_m += difference.effect.adds_m;
    using differences::Cause;
    if (difference.cause == Cause::kTiltX || difference.cause == Cause::kTiltY) {
      joint.tilt_rad = std::hypot(joint.tilt_rad, difference.value);
    } else if (difference.cause == Cause::kShiftX || difference.cause == Cause::kShiftY) {
      joint.shift_m = std::hypot(joint.shift_m, difference.value);
    } else if (difference.cause == Cause::kZero) {
      joint.zero = difference.value;
    }
  }
  for (std::size_t i = 0; i < n; ++i) comparison.joints[i].type = actual->arm.joints[i].type;
  if (comparison.bends) compare_bends(*bent_before, *bent_now, comparison);
  return comparison;
}

}  // namespace armsig::fleet
