// SPDX-License-Identifier: MIT
// What gravity turns or shifts the joints by (docs/model.md, section 7), in the servo tick.
//
// Of an axis z and a weight at r from it, in an upright frame U with its z axis up, the lever is
// z . (r x down) = z_y r_x - z_x r_y: the horizontal rows of the frames suffice. Turning all of the
// arm about the vertical changes no lever, so that a vertical first joint is left where it is; nor
// is a frame computed that no weight hangs at.
#pragma once

#include "core/calibration/packed_deflections.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::calibration {

class ServoGravity {
 public:
  using Values = std::array<double, kMaxJoints>;

  ServoGravity() = default;
  // In place, as all of it is large for a small stack. Precondition: check() accepts `deflections`
  // of `drawing`.
  void set(const PackedDeflections& deflections, const Arm& drawing);

  [[nodiscard]] bool empty() const { return terms_.empty(); }

  // Rad or m of each joint at effective readings q. Precondition: they are finite.
  void at(const Values& q, Values& by) const;

  // longest_lever_m() of the nominal arm.
  [[nodiscard]] double lever_m() const { return lever_m_; }
  // No joint gives way by more; and by how much more, where all readings together change by one.
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] double steepest() const { return steepest_; }

 private:
  struct Weight {
    double coefficient = 0;
    std::size_t origin = 0;
  };
  // Weights of one joint: those before `end`, from the end of the run before.
  struct Run {
    std::uint8_t joint = 0;
    std::uint8_t end = 0;
    bool turns = true;
    double sum = 0;  // of the coefficients
  };

  void stand(const Arm& nominal, const Vector3& up_0);
  void find_bounds();

  kinematics::Chain drawing_;  // its frames where Denavit and Hartenberg put them, to the last one
                               // that is needed
  // Frame `first_` in U, row by row: x, y, z axes and origin. 1 where joint 1 is vertical and
  // revolute, with its reading zero; else 0.
  std::array<std::array<double, 4>, 3> first_rows_{};
  std::size_t first_ = 0;
  FixedVector<Weight, kMaxGravityTerms> terms_;
  FixedVector<Run, kMaxJoints> runs_;
  bool slides_ = false;  // a slide gives way
  double lever_m_ = 0;
  double largest_ = 0;
  double steepest_ = 0;
};

}  // namespace armsig::calibration
