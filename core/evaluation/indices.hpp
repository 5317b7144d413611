// SPDX-License-Identifier: MIT
// The four indices of kinematic performance of the paper's Table 3, from the poses read at the
// vertices of a grid.
#pragma once

#include "core/evaluation/grid.hpp"

namespace armsig::evaluation {

// What the measuring machine read at each vertex, in the workspace frame, in the order of
// Grid::index.
struct GridReadings {
  FixedVector<Vector3, kMaxVertices> p_W;
  FixedVector<Vector3, kMaxVertices>
      turn_rad;  // rotation vector from the orientation at the first taught point
};

// The resolution of the measuring machine: 0.001 inch and 0.01 degree (section 4).
struct Resolution {
  double position_m = 25.4e-6;
  double angle_rad = radians(0.01);
};

struct Indices {
  double normal_deviation_m =
      0;  // largest distance of a point from the line fitted to its grid line
  double perpendicular_deviation_rad =
      0;                          // largest deviation from 90 degrees between grid lines that cross
  double radial_deviation_m = 0;  // largest distance of a point from its desired location
  double orientation_deviation_rad = 0;  // largest turn of the tool from its desired orientation
};

// Rounds to the resolution, as a reading does.
void quantise(GridReadings& readings, const Resolution& resolution);

// Precondition: readings.p_W and readings.turn_rad hold grid.vertex_count() values.
[[nodiscard]] Indices indices(const Grid& grid, const GridReadings& readings);

}  // namespace armsig::evaluation
