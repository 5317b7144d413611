// SPDX-License-Identifier: MIT
// Where an arm exactly as drawn may stand, from the rows of all its targets at once.
//
// With M the rotation from sensor to base, c and u_t unknown, M y = c + p + R u_t for a target u_t
// on a link at (p, R). All but M is linear and eliminated, which leaves a quadratic form in the
// nine elements of M; its minima over the rotations are looked for from everywhere.
#pragma once

#include <span>
#include <vector>

#include "core/base/pose.hpp"

namespace armsig::tool {

struct PlacedRow {
  Pose X_BL;  // of the target's link, by the drawing
  Vector3 p_S = Vector3::Zero();
  std::size_t target = 0;
};

struct BasePlace {
  Pose X_SB;
  std::vector<Vector3> p_LT;  // a target each
  double rms_m = 0;
};

// The best place first, then others nearly as good; nothing without rows.
[[nodiscard]] std::vector<BasePlace> find_base(std::span<const PlacedRow> rows,
                                               std::size_t targets);

}  // namespace armsig::tool
