// SPDX-License-Identifier: MIT
#include "firmware/fleet/host/signature_comparison.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <numbers>

#include <fmt/format.h>

#include "core/evaluation/differences.hpp"
#include "core/identification.hpp"

namespace armsig::fleet {
namespace {

constexpr double kLargest = 1e9;  // degrees or mm; an arm has none such

// Takes `name=NUMBER` from the front of `text`, with the space after it.
bool take(std::string_view& text, const std::string& name, double& value) {
  if (!text.starts_with(name) || text.substr(name.size(), 1) != "=") return false;
  text.remove_prefix(name.size() + 1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !(std::abs(value) < kLargest)) return false;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (text.empty()) return true;
  if (!text.starts_with(' ')) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::optional<Arm> arm_of_document(std::string_view document) {
  Arm arm;
  while (!document.empty()) {
    const std::size_t i = arm.joints.size() + 1;
    if (i > kMaxJoints) return std::nullopt;
    std::array<double, 4> row{};
    const bool good = take(document, fmt::format("theta{}_deg", i), row[0]) &&
                      take(document, fmt::format("d{}_mm", i), row[1]) &&
                      take(document, fmt::format("a{}_mm", i), row[2]) &&
                      take(document, fmt::format("alpha{}_deg", i), row[3]);
    if (!good) return std::nullopt;
    DhJoint joint;
    joint.theta_rad = radians(row[0]);
    joint.d_m = 1e-3 * row[1];
    joint.a_m = 1e-3 * row[2];
    joint.alpha_rad = radians(row[3]);
    arm.joints.push_back(joint);
    arm.limits.push_back({.lower = -std::numbers::pi, .upper = std::numbers::pi});
  }
  if (arm.joints.empty()) return std::nullopt;
  return arm;
}

std::optional<SignatureComparison> compare_signatures(std::string_view before,
                                                      std::string_view now) {
  const auto former = arm_of_document(before);
  const auto actual = arm_of_document(now);
  if (!former || !actual || former->joints.size() != actual->joints.size()) return std::nullopt;
  const std::size_t n = actual->joints.size();
  // Too large for a stack. Without unknowns: exact.
  const auto exact = std::make_unique<refinement::Refined>();
  const KnownTarget tool{.number = 1, .link = n, .p_F = Vector3(0, 0, 0.1)};
  exact->signature = signature_of(*actual, JointVector(n), {}, std::span(&tool, 1));
  const auto found = evaluation::differences(*former, *exact, 0);
  if (!found) return std::nullopt;
  SignatureComparison comparison{.joints = std::vector<JointDifference>(n),
                                 .tool_rms_m = found->total_rms_m};
  for (const evaluation::Difference& difference : found->all) {
    JointDifference& joint = comparison.joints[difference.joint];
    joint.adds_m += difference.effect.adds_m;
    using evaluation::Cause;
    if (difference.cause == Cause::kTiltX || difference.cause == Cause::kTiltY) {
      joint.tilt_rad = std::hypot(joint.tilt_rad, difference.value);
    } else if (difference.cause == Cause::kShiftX || difference.cause == Cause::kShiftY) {
      joint.shift_m = std::hypot(joint.shift_m, difference.value);
    } else if (difference.cause == Cause::kZero) {
      joint.zero_rad = difference.value;
    }
  }
  return comparison;
}

}  // namespace armsig::fleet
