// SPDX-License-Identifier: MIT
// Arm descriptions out of the files of other software.
#pragma once

#include "firmware/host_tool/imports/axis_chain.hpp"

namespace armsig::tool {

struct ImportedArm {
  ArmDescription description;
  std::vector<std::string> notes;  // what a person should know
};

// The chain from link `base` to link `tip` of a URDF file (xacro must be expanded before).
// Revolute, continuous and prismatic joints become joints, fixed ones part of the geometry; a mimic
// joint about the axis of the joint after it becomes a coupling. Continuous joints get -180 to 180
// degrees.
[[nodiscard]] Read<ImportedArm> import_urdf(const std::string& path, const std::string& base,
                                            const std::string& tip);

// Denavit-Hartenberg rows (CSV) as `armsig export` writes them: standard with the columns theta, d,
// a, alpha, modified with alpha_prev, a_prev, theta, d, each in _rad or _deg, _m or _mm.
[[nodiscard]] Read<ImportedArm> import_dh(const std::string& path);

}  // namespace armsig::tool
