// SPDX-License-Identifier: MIT
// The encoder-referenced circle: p = c + A cos t + B sin t with |A| = |B|, A perpendicular to B.
//
// The unconstrained model is linear (9 unknowns) and its triangular factor says everything that the
// points said. The circle (7 unknowns) of greatest likelihood is found on that factor alone: in the
// closed form of orthogonal Procrustes where the points are equally good in all directions, by
// Gauss-Newton from there where not. The cost does not grow with the sweep.
#pragma once

#include "core/base/error.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// A circle followed by the joint reading, with its uncertainty. Sensor frame, metres and radians.
struct CircleFit {
  Vector3 centre_S = Vector3::Zero();
  Matrix3 R_SC = Matrix3::Identity();  // columns: towards the target at the origin reading, along
                                       // its motion there, axis
  double radius_m = 0;
  // Of (centre, rotation vector of R_SC in S, radius), where the points' covariances are as given.
  Eigen::Matrix<double, 7, 7> covariance = Eigen::Matrix<double, 7, 7>::Zero();

  // The coefficients of the motion model that describe this circle, about statistics.origin_S.
  [[nodiscard]] MotionRls::Coefficients motion(const Vector3& origin_S) const;
};

// Errors: kSingular (the readings do not determine a circle), kNotConverged.
[[nodiscard]] Result<CircleFit> encoder_circle(const MotionStatistics& statistics);

}  // namespace armsig::features
