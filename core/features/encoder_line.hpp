// SPDX-License-Identifier: MIT
// The encoder-referenced line: p = c + u t with |u| = 1, for a prismatic joint.
#pragma once

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// A line followed by the joint reading, with its uncertainty. Sensor frame, metres and radians.
struct LineFit {
  Vector3 point_S = Vector3::Zero();       // the target at the origin reading
  Vector3 direction_S = Vector3::UnitZ();  // unit, positive sense of the reading
  // Of (point, rotation vector of the direction in S, 0), where the points' covariances are as
  // given; laid out like that of a circle.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();

  // The coefficients of the motion model that describe this line, about origin_S.
  [[nodiscard]] MotionRls::Coefficients motion(const Vector3& origin_S) const;
};

// Errors: kSingular (the readings do not determine a line), kNotConverged.
[[nodiscard]] Result<LineFit> encoder_line(const MotionStatistics& statistics);

}  // namespace armsig::features
