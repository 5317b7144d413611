// SPDX-License-Identifier: MIT
#include "core/frames/axis_lines.hpp"

#include <algorithm>

#include "core/frames/link_frames.hpp"

namespace armsig::frames {
namespace {

// Moves the point of each revolute line along it to where the sum of squared distances to the other
// revolute axes is least. A parallel axis is everywhere as near, so the distances to the other
// points count with a small weight: it decides among axes parallel within some degrees, and only
// there.
void move_points_near_arm(AxisLines& lines) {
  constexpr double kPointWeight = 1e-2;
  const AxisLines before = lines;
  for (AxisLine& line : lines) {
    double slope = 0;
    double curvature = 0;
    for (const AxisLine& other : before) {
      if (line.type != JointType::kRevolute || other.type != JointType::kRevolute) continue;
      const Vector3 apart = line.point - other.point;
      const Vector3 across = line.direction - other.direction * other.direction.dot(line.direction);
      slope += across.dot(apart) + kPointWeight * line.direction.dot(apart);
      curvature += across.squaredNorm() + kPointWeight;
    }
    if (curvature > 0) line.point -= line.direction * (slope / curvature);
  }
}

}  // namespace

AxisLines axis_lines(const FixedVector<Pose, kMaxFrames>& X_WL, const JointTypes& types) {
  ARMSIG_CHECK(X_WL.size() == types.size() + 1);
  AxisLines lines;
  for (std::size_t i = 0; i < types.size(); ++i) {
    lines.push_back({types[i], X_WL[i].R.col(2), X_WL[i].p});
  }
  move_points_near_arm(lines);
  return lines;
}

AxisLines axis_lines(const Arm& arm, const JointVector& readings) {
  return axis_lines(link_frames(arm.joints, readings).X_0L, types_of(arm.joints));
}

AxisLines axis_lines(const Signature& signature) {
  return axis_lines(signature.X_SL, signature.types);
}

double arm_size(const AxisLines& lines) {
  double size_m = 0.1;
  for (const AxisLine& a : lines) {
    for (const AxisLine& b : lines) {
      if (a.type != JointType::kRevolute || b.type != JointType::kRevolute) continue;
      size_m = std::max(size_m, (a.point - b.point).norm());
    }
  }
  return size_m;
}

}  // namespace armsig::frames
