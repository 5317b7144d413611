// SPDX-License-Identifier: MIT
// Drawing and actual arm as bent lines from base to tool, in the sensor frame, at configurations
// along a path through the joint space.
#pragma once

#include <vector>

#include "firmware/formats/signature_record.hpp"

namespace armsig::tool {

// Base; for each joint a point on its axis, a second one further along the axis, and the point
// where the drawing bends towards the next axis; the tool where the arm has one.
using BentLine = std::vector<Vector3>;

struct ArmFrame {
  BentLine nominal;
  BentLine actual;
};

struct ArmDrawing {
  bool has_tool = false;           // a target on the last link
  std::vector<JointVector> poses;  // effective readings
  std::vector<ArmFrame> frames;    // one a pose; the first at the signature configuration
};

// The drawing is laid over the arm's axes as well as it goes, and has its tool where the arm has it
// at the signature configuration, as taught.
[[nodiscard]] ArmDrawing arm_drawing(const SignatureRecord& record);

}  // namespace armsig::tool
