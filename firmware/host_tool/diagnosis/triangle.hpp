// SPDX-License-Identifier: MIT
// Of a lower triangle, by panels of columns: half of its numbers are zero, and a product or a
// solution that does not know it costs three times as much.
#pragma once

#include <Eigen/Core>

namespace armsig::tool {

// The inverse of the lower triangle of L; what L has above its diagonal is not looked at.
[[nodiscard]] Eigen::MatrixXd inverse_of_lower(const Eigen::MatrixXd& L);

// R^T R of a matrix that is zero above its diagonal.
[[nodiscard]] Eigen::MatrixXd square_of_lower(const Eigen::MatrixXd& R);

}  // namespace armsig::tool
