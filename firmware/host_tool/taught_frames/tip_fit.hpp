// SPDX-License-Identifier: MIT
// The tip of a tool from poses of the flange at which it touched one fixed point (docs/model.md,
// section 14).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "core/base/pose.hpp"

namespace armsig::tool {

// E is the controller's flange, C the controller's base.
struct TipFit {
  Vector3 t_E = Vector3::Zero();     // the tip
  Vector3 tip_C = Vector3::Zero();   // the fixed point
  std::vector<Vector3> residuals_C;  // of each pose: where its tip is, from the fixed point
  // Derivative by the poses: t_E, then tip_C; 6 columns a pose, its origin and its turn about the
  // axes of C.
  Eigen::MatrixXd by_poses;

  [[nodiscard]] double residual_squares() const;
};

// The direction of the flange that the poses turn least, and the largest angle between two poses of
// it. Along a direction that does not turn a tip is not determined.
struct LeastTurned {
  Vector3 direction_E = Vector3::UnitZ();
  double angle_rad = 0;
};
[[nodiscard]] LeastTurned least_turned(const std::vector<Pose>& X_CE);

// Least squares of X_CE t_E - tip_C. Preconditions: three poses or more; least_turned() is not
// zero.
[[nodiscard]] TipFit fit_tip(const std::vector<Pose>& X_CE);

}  // namespace armsig::tool
