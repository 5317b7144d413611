// SPDX-License-Identifier: MIT
#include "core/evaluation/grid_touching.hpp"

#include "core/evaluation/tool_pose.hpp"

namespace armsig::evaluation {
namespace {

// The workspace frame as `model` believes it to be: from its own forward kinematics at the taught
// readings.
struct TaughtWorkspace {
  Pose X_0W;
  Matrix3 R_0T;  // orientation at the first taught point
};

Result<TaughtWorkspace> teach(const ToolModel& model, const TaughtReadings& taught) {
  ARMSIG_TRY(origin, tool_pose(model, taught[0]));
  ARMSIG_TRY(on_x, tool_pose(model, taught[1]));
  ARMSIG_TRY(on_xy, tool_pose(model, taught[2]));
  return TaughtWorkspace{taught_frame(origin.p, on_x.p, on_xy.p), origin.R};
}

}  // namespace

Result<GridReadings> touch_grid(const ToolModel& model, const ToolModel& truth,
                                const GridPlacement& placement) {
  const Grid& grid = placement.grid;
  ARMSIG_CHECK(grid.vertex_count() <= kMaxVertices);
  ARMSIG_TRY(believed, teach(model, placement.taught));
  ARMSIG_TRY(real, teach(truth, placement.taught));
  const Pose X_W0 = real.X_0W.inverse();

  GridReadings readings;
  VertexWalk walk(grid, placement.taught[0]);
  while (walk.next()) {
    const Pose X_0T{believed.R_0T, believed.X_0W * walk.vertex()};
    ARMSIG_TRY(q, joints_for_tool_pose(model, X_0T, walk.seed()));
    walk.reached(q);
    ARMSIG_TRY(actual, tool_pose(truth, q));
    readings.p_W.push_back(X_W0 * actual.p);
    readings.turn_rad.push_back(X_W0.R * rotation_vector(actual.R * real.R_0T.transpose()));
  }
  return readings;
}

}  // namespace armsig::evaluation
