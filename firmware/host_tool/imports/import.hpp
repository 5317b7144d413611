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
// joint about the axis of the joint after it becomes a coupling, and its offset part of the
// geometry. Continuous joints have no limits.
[[nodiscard]] Read<ImportedArm> import_urdf(const std::string& path, const std::string& base,
                                            const std::string& tip);

// The kinematics of the drivers of Universal Robots (YAML): default_kinematics.yaml, and what they
// write of a robot's factory calibration.
[[nodiscard]] Read<ImportedArm> import_ur_yaml(const std::string& path);

// The parameters of opw_kinematics (YAML): an ortho-parallel basis with a spherical wrist.
[[nodiscard]] Read<ImportedArm> import_opw(const std::string& path);

// The arm of axes in a base whose z axis is up.
[[nodiscard]] ImportedArm described(const AxisChain& chain, std::string name,
                                    std::vector<std::string> joint_names);

// Denavit-Hartenberg rows (CSV) as `armsig export` writes them: standard with the columns theta, d,
// a, alpha, modified with alpha_prev, a_prev, theta, d, each in _rad or _deg, _m or _mm; and as
// spreadsheets write them.
[[nodiscard]] Read<ImportedArm> import_dh(const std::string& path);

}  // namespace armsig::tool
