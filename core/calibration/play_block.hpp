// SPDX-License-Identifier: MIT
// Half of every joint's play among the unknowns of a fit, where rows tell from which sides the
// joints came to them.
//
// A joint stays behind its motor by half of its play h_i, on the side that it comes from: what a
// row measured is off by -sum_i side_i h_i motion_i. (A drive that overshoots by more than the play
// ends on the other side: h_i is then negative, and as large.) Where the sides change without
// regard to the pose, no joint error maps and no gravity looks like that for many poses; for few
// it does, so that residuals of a fit that does not know of play have lost up to half of it.
#pragma once

#include <array>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"
#include "core/calibration/fit_row.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::calibration {

// 1: the reading of the joint grew when it came to the row's pose; -1: it fell; 0: nobody knows.
[[nodiscard]] inline double side_at(const FitRow& row, std::size_t joint) {
  if ((row.sided >> joint & 1U) == 0) return 0;
  return (row.sides >> joint & 1U) != 0 ? 1 : -1;
}

struct PlayBlock {
  using Numbers = numerics::Column;
  using Square = numerics::Square;

  Numbers half = Numbers::Zero();  // of each joint's play [rad or m]: what was found
  // After a fit: what the rows pull at it, J^T W r over sigma^2, as much as the prior holds it
  // back; and what they say of it, the inverse of its covariance without that prior, all other
  // unknowns free to follow it (Frisch and Waugh, Econometrica 1, 1933, 387-401).
  Numbers gradient = Numbers::Zero();
  Square told = Square::Zero();
  // Of the engine's computation under way.
  Numbers step = Numbers::Zero();
  Square information = Square::Zero();  // J^T W J of the rows
  Square factor = Square::Zero();       // Cholesky's, lower, of the covariance's inverse
};

}  // namespace armsig::calibration
