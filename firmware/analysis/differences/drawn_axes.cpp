// SPDX-License-Identifier: MIT
#include "firmware/analysis/differences/drawn_axes.hpp"

#include "core/base/low_discrepancy.hpp"
#include "core/frames/link_frames.hpp"

namespace armsig::differences {
namespace {

using frames::KnownLinkFrames;

// Axes below this angle have no common perpendicular that a person could find.
constexpr double kParallelSine = 0.02;
// Axes nearer than this meet.
constexpr double kMeet_m = 1e-6;
// Parallel axes nearer than this tell no zero: half a millimetre would be degrees.
constexpr double kLeastLink_m = 0.02;
// The axis after and the tool decide where an axis stands only as far as the axis before does not.
constexpr double kAxisAfterWeight = 1e-3;
constexpr double kToolWeight = 1e-6;
constexpr int kToolPlaces = 100;

using Points = FixedVector<Vector3, kMaxJoints>;

// Per joint, the mean over the work volume of where the tool is as the link before sees it, in the
// base frame with all joints at zero.
Points tool_middles(const Arm& drawing, const KnownLinkFrames& at_zero, const Vector3& p_nT) {
  const auto types = types_of(drawing.joints);
  Points middles(drawing.joints.size(), Vector3::Zero());
  for (int k = 1; k <= kToolPlaces; ++k) {
    const JointVector q = evenly_spread_configuration(types, drawing.limits, k);
    const KnownLinkFrames at_q = frames::link_frames(drawing.joints, q);
    const Vector3 p_0T = at_q.X_0L.back() * p_nT;
    for (std::size_t i = 0; i < middles.size(); ++i) {
      // Frames of a link differ by how far along its axis they stand.
      const Vector3 along(0, 0, at_zero.along_m[i] - at_q.along_m[i]);
      const Vector3 p_L = at_q.X_0L[i].inverse() * p_0T + along;
      middles[i] += at_zero.X_0L[i] * p_L / kToolPlaces;
    }
  }
  return middles;
}

// The nearest joint in steps of `step` from `i` that is revolute; `i` itself if there is none.
std::size_t revolute_neighbour(const Arm& drawing, std::size_t i, int step) {
  for (std::size_t k = i + static_cast<std::size_t>(step); k < drawing.joints.size();
       k += static_cast<std::size_t>(step)) {
    if (drawing.joints[k].type == JointType::kRevolute) return k;
  }
  return i;
}

// The point of revolute axis i nearest, in weighted least squares, to its neighbours and the tool.
Vector3 centre_of(const Arm& drawing, const KnownLinkFrames& known, std::size_t i,
                  const Vector3& middle) {
  const Vector3 z = known.X_0L[i].R.col(2);
  const Vector3 p = known.X_0L[i].p;
  double curvature = kToolWeight;
  double slope = kToolWeight * z.dot(p - middle);
  const auto nearest_to = [&](std::size_t k, double weight) {
    if (k == i) return;
    const Vector3 z_k = known.X_0L[k].R.col(2);
    const Vector3 across = z - z_k * z_k.dot(z);
    slope += weight * across.dot(p - known.X_0L[k].p);
    curvature += weight * across.squaredNorm();
  };
  nearest_to(revolute_neighbour(drawing, i, -1), 1);
  nearest_to(revolute_neighbour(drawing, i, 1), kAxisAfterWeight);
  return p - z * (slope / curvature);
}

// Sets heading and other; the direction of x, perpendicular to z.
Vector3 heading_of(const KnownLinkFrames& known, std::size_t i, const Points& centres,
                   const Arm& drawing, const Vector3& p_0T, DrawnAxis& axis) {
  const Vector3 z = known.X_0L[i].R.col(2);
  const auto across = [&](const Vector3& v) { return Vector3(v - z * z.dot(v)); };
  if (i > 0) {
    axis.other = i - 1;
    const Vector3 before = across(known.X_0L[i - 1].R.col(2));
    if (before.norm() > kParallelSine) {
      axis.heading = Heading::kAlongAxis;
      const Vector3 x = before.normalized();
      const double apart = z.cross(x).dot(centres[i] - known.X_0L[i - 1].p);
      const bool turns = drawing.joints[i - 1].type == JointType::kRevolute;
      axis.of_zero = turns ? Deviation::kTiltX : Deviation::kShiftX;
      if (turns && std::abs(apart) > kMeet_m) axis.y_away = apart > 0 ? 1 : -1;
      return x;
    }
  }
  for (std::size_t k = i; k-- > 0;) {
    if (drawing.joints[k].type == JointType::kPrismatic) continue;
    const Vector3 z_k = known.X_0L[k].R.col(2);
    const Vector3 apart = across(centres[i] - known.X_0L[k].p);
    if (z_k.cross(z).norm() > kParallelSine || apart.norm() < kMeet_m) break;
    axis.heading = Heading::kAwayFromAxis;
    axis.other = k;
    if (apart.norm() > kLeastLink_m) axis.of_zero = Deviation::kShiftY;
    return apart.normalized();
  }
  const Vector3 to_tool = across(p_0T - centres[i]);
  return to_tool.norm() > kMeet_m ? Vector3(to_tool.normalized()) : any_perpendicular(z);
}

}  // namespace

FixedVector<DrawnAxis, kMaxJoints> drawn_axes(const Arm& drawing, const Vector3& p_nT) {
  const std::size_t n = drawing.joints.size();
  ARMSIG_CHECK(n > 0 && drawing.limits.size() == n);
  const KnownLinkFrames known = frames::link_frames(drawing.joints, JointVector(n));
  const Vector3 p_0T = known.X_0L[n] * p_nT;
  Points centres = tool_middles(drawing, known, p_nT);
  for (std::size_t i = 0; i < n; ++i) {
    if (drawing.joints[i].type == JointType::kPrismatic) continue;
    centres[i] = centre_of(drawing, known, i, centres[i]);
  }
  FixedVector<DrawnAxis, kMaxJoints> axes;
  Pose X_0_before;
  for (std::size_t i = 0; i < n; ++i) {
    DrawnAxis axis;
    axis.type = drawing.joints[i].type;
    Pose X_0A;
    X_0A.p = centres[i];
    X_0A.R.col(2) = known.X_0L[i].R.col(2);
    X_0A.R.col(0) = heading_of(known, i, centres, drawing, p_0T, axis);
    X_0A.R.col(1) = X_0A.R.col(2).cross(X_0A.R.col(0));
    axis.X_before = X_0_before.inverse() * X_0A;
    axes.push_back(axis);
    X_0_before = X_0A;
  }
  return axes;
}

}  // namespace armsig::differences
