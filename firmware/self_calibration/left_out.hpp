// SPDX-License-Identifier: MIT
// A fitted row as if it had been left out of its fit.
#pragma once

#include <optional>

#include "core/calibration/engine.hpp"

namespace armsig::controller {

// What the row would be missed by, what of that is the row's own and by how much it is to be
// expected in all, in the directions that the other rows tell something of; nothing in the others.
struct LeftOut {
  Vector3 error_m = Vector3::Zero();
  Matrix3 row_m2 = Matrix3::Zero();
  Matrix3 covariance_m2 = Matrix3::Zero();
  Matrix3 information = Matrix3::Zero();  // inverse of the covariance in those directions [1/m^2]
};

// By the linear fit, from the row's residual and what was stated for it with the row (Cook and
// Weisberg, Residuals and Influence in Regression, 1982, section 2.2). A direction that the row
// determines to more than four fifths is left out, as there the least bend of the model would count
// many times. None where that is every direction.
[[nodiscard]] std::optional<LeftOut> left_out(const Vector3& residual,
                                              const calibration::Engine::Stated& with_it);

}  // namespace armsig::controller
