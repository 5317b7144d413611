// SPDX-License-Identifier: MIT
// The joint axes of an arm as lines in space: what two models of one arm have in common.
//
// Lines, unlike Denavit-Hartenberg parameters, stay comparable near parallel axes, as long as they
// are compared near the arm: each line carries the point of it that is nearest to the other axes.
#pragma once

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/signature.hpp"

namespace armsig::frames {

// A revolute joint is a directed line; of a prismatic joint only the direction means anything.
struct AxisLine {
  JointType type = JointType::kRevolute;
  Vector3 direction = Vector3::UnitZ();  // unit; positive sense of the reading
  Vector3 point = Vector3::Zero();       // on the line, near the arm; metres
};
using AxisLines = FixedVector<AxisLine, kMaxJoints>;

// In the arm's base frame at the given readings (effective ones: couplings applied).
[[nodiscard]] AxisLines axis_lines(const Arm& arm, const JointVector& readings);

// Of link frames 0 ... n at some readings, in the frame W that they are told in.
[[nodiscard]] AxisLines axis_lines(const FixedVector<Pose, kMaxFrames>& X_WL,
                                   const JointTypes& types);

// In the sensor frame at the signature configuration.
[[nodiscard]] AxisLines axis_lines(const Signature& signature);

// The greatest distance between the points of two revolute axes, at least 0.1 m (a wrist whose axes
// meet has no size of its own).
[[nodiscard]] double arm_size(const AxisLines& lines);

}  // namespace armsig::frames
