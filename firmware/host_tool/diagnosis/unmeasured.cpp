// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/unmeasured.hpp"

#include <algorithm>

#include <fmt/core.h>

#include "core/base/pose.hpp"
#include "firmware/host_tool/presentation/words.hpp"

namespace armsig::tool {
namespace {

constexpr double kBeyond_rad = radians(5.0);
constexpr double kBeyond_m = 0.02;
constexpr std::size_t kOneIn = 10;  // rows

}  // namespace

std::vector<UnmeasuredJoint> unmeasured_joints(const calibration::ArmModel* deflections,
                                               std::span<const calibration::Observation> rows) {
  std::vector<UnmeasuredJoint> unmeasured;
  if (deflections == nullptr || rows.empty()) return unmeasured;
  // One joint at least has moved where this is known of any.
  const bool known = std::ranges::any_of(deflections->joints, [](const auto& joint) {
    return joint.covered.lower < joint.covered.upper;
  });
  if (!known) return unmeasured;
  for (std::size_t j = 0; j < deflections->joints.size(); ++j) {
    const calibration::JointModel& joint = deflections->joints[j];
    const JointLimits& measured = joint.covered;
    const double beyond = joint.type == JointType::kRevolute ? kBeyond_rad : kBeyond_m;
    UnmeasuredJoint found{j, joint.type, measured, {rows[0].readings[j], rows[0].readings[j]}};
    std::size_t count = 0;
    for (const calibration::Observation& row : rows) {
      const double q = row.readings[j];
      found.read.lower = std::min(found.read.lower, q);
      found.read.upper = std::max(found.read.upper, q);
      if (q < measured.lower - beyond || q > measured.upper + beyond) ++count;
    }
    if (kOneIn * count > rows.size()) unmeasured.push_back(found);
  }
  return unmeasured;
}

std::string in_words(const UnmeasuredJoint& unmeasured) {
  const auto words = [&](double q) { return reading_in_words(unmeasured.type, q); };
  return fmt::format("joint {} reads {} to {}, and the signature was measured from {} to {}",
                     unmeasured.joint + 1, words(unmeasured.read.lower),
                     words(unmeasured.read.upper), words(unmeasured.measured.lower),
                     words(unmeasured.measured.upper));
}

}  // namespace armsig::tool
