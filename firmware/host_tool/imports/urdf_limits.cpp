// SPDX-License-Identifier: MIT
#include "firmware/host_tool/imports/urdf_limits.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "core/base/error.hpp"
#include "core/base/joint_range.hpp"
#include "firmware/formats/infinity.hpp"
#include "firmware/formats/text.hpp"
#include "firmware/host_tool/imports/plausible.hpp"

namespace armsig::tool {
namespace {

using tinyxml2::XMLElement;

// A number, or infinity as files write it.
Read<double> limit_attribute(const XMLElement& limit, const char* name) {
  if (const auto infinity = parse_infinity(attribute(limit, name))) return *infinity;
  return number_attribute(limit, name, 0);
}

std::unexpected<Problem> limit_problem(const XMLElement& limit, const UrdfJoint& joint,
                                       const JointLimits& limits, std::string expected) {
  return problem_at(
      limit,
      fmt::format("limit of joint {}: {} to {}", in_quotes(joint.name), limits.lower, limits.upper),
      std::move(expected));
}

Read<UrdfLimits> turning_limits(const XMLElement& limit, const UrdfJoint& joint,
                                const JointLimits& limits) {
  const bool no_lower = limits.lower <= -kNoLimit_rad;
  const bool no_upper = limits.upper >= kNoLimit_rad;
  if (no_lower && no_upper) return UrdfLimits{kNoLimits, true};
  if (no_lower || no_upper) {
    return limit_problem(limit, joint, limits, "both limits, or type=\"continuous\"");
  }
  if (std::max(-limits.lower, limits.upper) > kMostTurns_rad) {
    return limit_problem(limit, joint, limits,
                         "radians; type=\"continuous\" of a joint that turns without end");
  }
  return UrdfLimits{limits, false};
}

Read<UrdfLimits> sliding_limits(const XMLElement& limit, const UrdfJoint& joint,
                                const JointLimits& limits) {
  if (std::max(-limits.lower, limits.upper) > kMostStroke_m) {
    return limit_problem(limit, joint, limits, "metres, and both ends of the slide");
  }
  return UrdfLimits{limits, false};
}

}  // namespace

Read<UrdfLimits> urdf_limits(const UrdfJoint& joint) {
  if (attribute(*joint.element, "type") == "continuous") return UrdfLimits{kNoLimits, false};
  const XMLElement* limit = joint.element->FirstChildElement("limit");
  if (limit == nullptr) {
    return problem_at(*joint.element, fmt::format("joint {} has no limit", in_quotes(joint.name)),
                      "<limit lower=... upper=...>");
  }
  ARMSIG_TRY(lower, limit_attribute(*limit, "lower"));
  ARMSIG_TRY(upper, limit_attribute(*limit, "upper"));
  const JointLimits limits{lower, upper};
  if (lower == 0 && upper == 0) {
    return limit_problem(*limit, joint, limits,
                         "the limits that the joint has; the exporter of SolidWorks writes 0 and "
                         "0 where none are given");
  }
  if (!(lower < upper)) {
    return problem_at(*limit,
                      fmt::format("limit of joint {}: lower {} is not below upper {}",
                                  in_quotes(joint.name), lower, upper),
                      "lower below upper");
  }
  return joint.motion == UrdfMotion::kSlides ? sliding_limits(*limit, joint, limits)
                                             : turning_limits(*limit, joint, limits);
}

}  // namespace armsig::tool
