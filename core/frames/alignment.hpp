// SPDX-License-Identifier: MIT
// Lays the joint axes of one model of an arm over those of another.
#pragma once

#include "core/frames/axis_lines.hpp"

namespace armsig::frames {

// What is left between two axes after the alignment.
struct Misalignment {
  double angle_rad = 0;   // between the directions, in [0, pi]
  double distance_m = 0;  // of B's point from A's line; 0 for a prismatic joint
};

struct Alignment {
  Pose X_AB;
  FixedVector<Misalignment, kMaxJoints> joints;
  double cost_m2 = 0;  // sum of squared distances and of squared size-weighted chords of direction

  [[nodiscard]] double worst_angle_rad() const;
  [[nodiscard]] double worst_distance_m() const;
};

// The rigid motion X_AB that lays lines B over lines A: least squares of the distances of B's
// points from A's lines and of the differences of direction, the latter weighted with the size of
// arrangement A. Gauss-Newton with step halving, at most 30 steps from each of the 24 rotations of
// a cube, until they are near a minimum; the least cost wins, the earlier start (the identity is
// the first) among equals, and its minimum is refined. A start without cost is followed by no
// other.
//
// A direction of motion that the lines determine to less than one part in a hundred is left at the
// start: the slide along axes that are all parallel within half a degree, the turn about a single
// axis, any translation where no joint is revolute. The start lays the mean of B's points on A's.
// Preconditions: 1 to 8 lines, as many in B as in A, of the same types; finite.
[[nodiscard]] Alignment align(const AxisLines& lines_A, const AxisLines& lines_B);

// align(), one Gauss-Newton step at a time, for those who have a tick to keep.
class Aligning {
 public:
  Aligning(const AxisLines& lines_A, const AxisLines& lines_B);

  // False if nothing is left to do. At most 25 * 30 steps.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] Alignment result() const;

 private:
  struct Descent {
    Pose X_AB;
    double cost_m2 = 0;
  };

  [[nodiscard]] Descent start() const;
  // Improves descent_; whether the step was longer than `near` times the size.
  [[nodiscard]] bool descend(double near);

  static constexpr int kStarts = 24;

  AxisLines lines_A_;
  AxisLines lines_B_;
  double size_m_;
  Vector3 mean_B_;
  int starts_ = 0;  // that have been followed; kStarts: the best is refined
  int steps_ = 0;   // from the present one
  Descent descent_;
  Descent best_;
};

}  // namespace armsig::frames
