// SPDX-License-Identifier: MIT
// Where the axes of an arm depart from its drawing, each from where the drawing puts it on the link
// before: the chain of the drawing with a small motion E_i between link i - 1 and joint i,
//   T(q) = X_SD G_1 E_1 J_1(q_1 + zero_1) G_2 E_2 J_2(q_2 + zero_2) ...,
// G_i of the drawing (DrawnAxis::X_before), E_i a tilt about x, y and a shift along x, y, J_i the
// motion of the joint.
//
// The lines do not fix all of it. The base stands on axis 1, and what a zero does just as well is
// laid to the zero (DrawnAxis::of_zero): what is left are Denavit and Hartenberg's four a joint
// where axes are not parallel, and Hayati's where they are. Where this leaves a choice (two slides
// along one line, a base that slides along axes all parallel), the least sum of squares of tilts,
// shifts and zeros over their tolerances decides. None of it depends on any frame.
#pragma once

#include "core/base/error.hpp"
#include "core/signature.hpp"
#include "firmware/analysis/differences/drawn_axes.hpp"

namespace armsig::differences {

// 1 sigma of what a workshop does, and of zeros, which are set by hand.
struct WorkshopTolerances {
  double tilt_rad = radians(0.1);
  double shift_m = 0.5e-3;
  double zero_rad = radians(10.0);
  double zero_m = 0.05;
  // Of the place of the base, laid by the axes: what keeps it where all axes are nearly parallel.
  double base_m = 0.05;
};

using DeviationValues = std::array<double, kMaxJoints * kDeviations>;

// Deviation `which` of joint `joint` among all.
[[nodiscard]] inline std::size_t deviation_index(std::size_t joint, Deviation which) {
  return joint * kDeviations + static_cast<std::size_t>(which);
}

// Derivatives by the lines of the signature, in the order of the columns that a layout gives them:
// direction x, y, position x, y of joint 1, then joint 2, ...; position columns of a prismatic
// joint are zero.
inline constexpr std::size_t kLineColumns = 4;
using LineDerivatives = std::array<double, kMaxJoints * kLineColumns>;

struct AxisDeviations {
  Pose X_SD;               // the base of the drawing in the sensor frame
  DeviationValues values;  // rad and m; a zero is that of the effective reading
  std::array<LineDerivatives, kMaxJoints * kDeviations> by_lines;
};

// Deviations of `signature` from the axes of its drawing, whose base is looked for about X_SD.
// Errors: kNotConverged where an axis is turned by more than some 60 degrees from the drawing.
// Preconditions: one axis a joint, of the same type.
[[nodiscard]] Result<AxisDeviations> axis_deviations(const FixedVector<DrawnAxis, kMaxJoints>& axes,
                                                     const Signature& signature, const Pose& X_SD,
                                                     const WorkshopTolerances& tolerances = {});

}  // namespace armsig::differences
