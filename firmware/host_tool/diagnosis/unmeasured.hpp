// SPDX-License-Identifier: MIT
// Joints that read elsewhere than where their deflections were measured.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/calibration/model.hpp"
#include "core/calibration/observation.hpp"

namespace armsig::tool {

struct UnmeasuredJoint {
  std::size_t joint = 0;  // from 0
  JointType type = JointType::kRevolute;
  JointLimits measured;  // readings of the rows that the signature was fitted to
  JointLimits read;      // readings of these rows
};

// Joints of which more than a tenth of the rows read more than 5° (20 mm) beyond what was measured.
// None of a signature without deflections, and of one that does not say what was measured.
[[nodiscard]] std::vector<UnmeasuredJoint> unmeasured_joints(
    const calibration::ArmModel* deflections, std::span<const calibration::Observation> rows);

// "joint 3 reads -40.000° to 61.000°, and the signature was measured from -0.012° to 0.014°".
[[nodiscard]] std::string in_words(const UnmeasuredJoint& unmeasured);

}  // namespace armsig::tool
