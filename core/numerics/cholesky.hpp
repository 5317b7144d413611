// SPDX-License-Identifier: MIT
// Cholesky's factor of small positive definite matrices, without the heap that Eigen's solve with a
// matrix refers to.
#pragma once

#include <Eigen/Core>

#include "core/base/arm.hpp"

namespace armsig::numerics {

using Column = Eigen::Matrix<double, kMaxJoints, 1>;
using Square = Eigen::Matrix<double, kMaxJoints, kMaxJoints>;

// The lower factor of the leading n x n block of the symmetric `a`, in place. False if it is not
// positive definite.
[[nodiscard]] bool factor_positive(Square& a, Eigen::Index n);

// Solve L x = b and L^T x = b for the lower triangle L of the leading n x n block of `lower`, x
// over b.
void solve_lower(const Square& lower, Column& b, Eigen::Index n);
void solve_lower_transposed(const Square& lower, Column& b, Eigen::Index n);

// Solves a x = b for the symmetric positive definite n x n `a` (factored in place; x over b). False
// if it is not positive definite.
[[nodiscard]] bool solve_positive(Square& a, Column& b, Eigen::Index n);

}  // namespace armsig::numerics
