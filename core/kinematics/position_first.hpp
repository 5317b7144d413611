// SPDX-License-Identifier: MIT
// The task of an arm of three to five joints: the position is met, and the motion that this leaves
// turns frame n as near to the orientation as it can. In rates, for the rows A of the Jacobian for
// the position and B for the orientation:
//   minimise |B dq - e_rotation|^2 subject to A dq = e_position,
// least squares with an equality constraint, by the null space (Lawson and Hanson, Solving Least
// Squares Problems, 1974, chapter 20).
#pragma once

#include <array>
#include <cstdint>

#include "core/kinematics/forward.hpp"
#include "core/kinematics/joint_box.hpp"

namespace armsig::kinematics {

using PoseError = Eigen::Matrix<double, 6, 1>;  // position [m], rotation vector [rad]

// Whether that is the task of `chain`: three to five joints, which move the origin of frame n in
// three directions in at least one of a few poses. Joints that move it in a plane, but for the
// deviations of their axes, do not. `chain` is complete but for Chain::position_first.
[[nodiscard]] bool is_position_first(const Chain& chain);

// What the Jacobian says of the task. Singular where the position alone has no single smallest
// step, as where an elbow is straight.
class PositionFirst {
 public:
  explicit PositionFirst(const Jacobian& J);

  // The rotation error that is left once the position is met by the smallest step. Precondition of
  // this and of step(): it is regular.
  [[nodiscard]] Vector3 rotation_left(const PoseError& error) const {
    return error.tail<3>() - turn_per_move_ * error.head<3>();
  }
  // The step of the task, of `n` joints. False where it has none.
  [[nodiscard]] bool step(const PoseError& error, Eigen::Index n, Joints& dq) const;
  // The volume of the motions that the task determines: sqrt(det(A A^T)) times that of B by the
  // motions that leave the position. With six columns that is |det J|. 0 where it is singular.
  [[nodiscard]] double volume(Eigen::Index n) const;
  [[nodiscard]] bool is_regular() const { return regular_; }

 private:
  using Rows = std::array<Vector3, kMaxJoints>;

  [[nodiscard]] Square normal(double added) const;

  Rows moves_;             // columns of A
  Rows stays_;             // of B, by motions that leave the position
  Matrix3 turn_per_move_;  // B by the smallest steps that meet a position
  bool regular_ = false;   // the two above have no value where it is false
};

enum class TaskStep : std::uint8_t {
  kFound,
  kSingular,  // the task has no step here
  kBounded,   // joints at their bounds keep the arm from the position
};

// The step of the task from readings q inside `box`: a joint that it would take out of the box goes
// to its bound, and the others do without it. Where those would not move the tip in three
// directions but for the deviations of their axes, the step is shortened instead: it ends at the
// bound.
[[nodiscard]] TaskStep position_first_step(const Chain& chain, Jacobian J, PoseError error,
                                           const JointBox& box, const Joints& q, Joints& dq);

}  // namespace armsig::kinematics
