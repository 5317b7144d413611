// SPDX-License-Identifier: MIT
// Every frame of a task by the poses that one model gives the flange at its rows.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "firmware/host_tool/taught_frames/taught_task.hpp"

namespace armsig::tool {

struct SolvedFrame {
  Pose X;                // X_ET of a tool, X_CW of a work object
  bool oriented = true;  // false of a tool without directions: it has the axes of the flange
  // Derivative of the frame by the poses X_CE of all rows of the task: 6 rows, its origin and its
  // turn about its own axes; 6 columns a row, its origin and its turn about the axes of C.
  Eigen::MatrixXd by_rows;
  // The same by the tip that touched a work object; by_rows has it where that tip is of the task.
  Eigen::Matrix<double, 6, 3> by_tip = Eigen::Matrix<double, 6, 3>::Zero();
  std::vector<double> misses_m;  // of each row of the frame
  double residual_squares = 0;   // m^2
  std::size_t freedom = 0;
  double rms_m = 0;  // of the misses of a tool's tips, of a work object's points
};

// One of every frame of the task. Refuses points that are too few, that turn too little, that are
// on a line, or that are not one tip.
[[nodiscard]] Read<std::vector<SolvedFrame>> solved_frames(const TaughtTask& task,
                                                           const std::vector<Pose>& X_CE);

}  // namespace armsig::tool
