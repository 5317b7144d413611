// SPDX-License-Identifier: MIT
// The tool of a model: where readings put it, which readings put it where, and the order in which a
// grid is walked.
#pragma once

#include "core/evaluation/grid_touching.hpp"
#include "core/kinematics/inverse.hpp"

namespace armsig::evaluation {

// Pose of the tool (the frame of the last link, moved to the tool point) in frame 0. Errors:
// kNotFinite.
[[nodiscard]] Result<Pose> tool_pose(const ToolModel& model, const JointVector& q);

// Joint readings that put the tool at X_0T, near `seed`. Errors: kOutOfReach, kJointLimit,
// kNotConverged, kNotFinite.
[[nodiscard]] Result<JointVector> joints_for_tool_pose(const ToolModel& model, const Pose& X_0T,
                                                       const JointVector& seed);

// The readings of an inverse without limits of its steps. Errors: kOutOfReach, kJointLimit,
// kNotConverged.
[[nodiscard]] Result<JointVector> readings_found(const kinematics::InverseSolution& solution);

// Visits the vertices of a grid in the order of Grid::index, each with the readings of the nearest
// vertex already reached as its seed.
class VertexWalk {
 public:
  VertexWalk(const Grid& grid, const JointVector& at_origin);

  // Moves on to the next vertex (at first, to the first); false after the last.
  [[nodiscard]] bool next();
  [[nodiscard]] Vector3 vertex() const { return grid_.vertex(at_[0], at_[1], at_[2]); }
  [[nodiscard]] const JointVector& seed() const;
  // Records the readings at the present vertex.
  void reached(const JointVector& q);

 private:
  const Grid& grid_;
  std::size_t visited_ = 0;
  std::array<std::size_t, 3> at_{};
  std::array<JointVector, 3> starts_;  // the vertex before, those that start the row and the layer
};

}  // namespace armsig::evaluation
