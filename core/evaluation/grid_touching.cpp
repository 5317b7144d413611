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

Result<TaughtWorkspace> teach(const ToolModel& model, const Turning& turning,
                              const TaughtReadings& taught) {
  ARMSIG_TRY(origin, tool_pose(model, turned(turning, taught[0])));
  ARMSIG_TRY(on_x, tool_pose(model, turned(turning, taught[1])));
  ARMSIG_TRY(on_xy, tool_pose(model, turned(turning, taught[2])));
  return TaughtWorkspace{taught_frame(origin.p, on_x.p, on_xy.p), origin.R};
}

}  // namespace

JointVector turned(const Turning& turning, const JointVector& effective) {
  if (turning.model == nullptr) return effective;
  return calibration::true_readings(*turning.model, turning.configuration,
                                    readings_for(turning.model->couplings, effective));
}

JointVector effective_for(const Turning& turning, const JointVector& axes) {
  if (turning.model == nullptr) return axes;
  return effective_readings(
      turning.model->couplings,
      calibration::encoder_readings(*turning.model, turning.configuration, axes));
}

Result<GridReadings> touch_grid(const ToolModel& model, const ToolModel& truth,
                                const GridPlacement& placement, const Turning& of_model,
                                const Turning& of_truth) {
  const Grid& grid = placement.grid;
  ARMSIG_CHECK(grid.vertex_count() <= kMaxVertices);
  ARMSIG_TRY(believed, teach(model, of_model, placement.taught));
  ARMSIG_TRY(real, teach(truth, of_truth, placement.taught));
  const Pose X_W0 = real.X_0W.inverse();

  GridReadings readings;
  VertexWalk walk(grid, placement.taught[0]);
  while (walk.next()) {
    const Pose X_0T{believed.R_0T, believed.X_0W * walk.vertex()};
    ARMSIG_TRY(axes, joints_for_tool_pose(model, X_0T, walk.seed()));
    walk.reached(axes);
    ARMSIG_TRY(actual, tool_pose(truth, turned(of_truth, effective_for(of_model, axes))));
    readings.p_W.push_back(X_W0 * actual.p);
    readings.turn_rad.push_back(X_W0.R * rotation_vector(actual.R * real.R_0T.transpose()));
  }
  return readings;
}

}  // namespace armsig::evaluation
