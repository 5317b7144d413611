// SPDX-License-Identifier: MIT
// Curves of readings along which joints can move together: seven joints that keep frame n at a
// pose, or six that keep it at a pose turned about a line, which is a seventh joint that no arm
// has.
//
// Where the turn about the line is zero, six joints are at a posture of the pose itself. From one
// posture its curve leads to others, however small the region from which Newton's method does;
// along a curve where the turn stays zero the six joints move without frame n. Followed by tangents
// and corrections (Allgower and Georg, Introduction to Numerical Continuation Methods, 1990).
#pragma once

#include <optional>

#include "core/base/pose.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics {

struct Line {
  Vector3 point = Vector3::Zero();  // in frame 0
  Vector3 direction = Vector3::UnitZ();
};

class MotionCurve {
 public:
  // Six or seven joints; `line` serves where there are six.
  MotionCurve(const Chain& chain, const Pose& X_0n, const Line& line);

  // Readings that meet the pose, and which way the curve is followed. False where the joints can
  // move in more ways than along one curve.
  [[nodiscard]] bool begin(const JointVector& q, bool forwards);
  // The next point. False at the end: back at the beginning, or where the curve can't be followed.
  [[nodiscard]] bool advance();
  [[nodiscard]] bool has_line() const { return has_line_; }
  // After the end: whether it is the whole curve.
  [[nodiscard]] bool is_whole() const { return whole_; }

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] JointVector readings() const { return readings_of(at_); }
  // Between the last two points, 0 at the last but one and 1 at the last: on the curve but for the
  // square of the step, and on it. Readings of revolute joints change without jumps of a turn.
  [[nodiscard]] JointVector near(double part) const;
  [[nodiscard]] JointVector exactly(double part) const;
  // From readings on the curve by so much along it, back if negative; nothing where that can't be.
  [[nodiscard]] std::optional<JointVector> from(const JointVector& q, double distance) const;
  // The turns about the line there, in (-pi, pi].
  [[nodiscard]] double turn_before() const;
  [[nodiscard]] double turn() const;

 private:
  // Angles, and lengths in units of the arm.
  using Unknowns = Eigen::Matrix<double, 7, 1>;
  using Residuals = Eigen::Matrix<double, 6, 1>;
  using Rates = Eigen::Matrix<double, 6, 7>;

  [[nodiscard]] Unknowns unknowns_of(const JointVector& q) const;
  [[nodiscard]] JointVector readings_of(const Unknowns& y) const;
  // What frame n misses, and how that changes. False where a reading is not finite.
  [[nodiscard]] bool evaluate(const Unknowns& y, Residuals& e, Rates& A) const;
  // The shortest step that removes e, and the direction of the curve, along the last one.
  [[nodiscard]] static bool solve(Rates A, Residuals e, const Unknowns& along, Unknowns& step,
                                  Unknowns& tangent);
  // From beside the curve onto it; `tangent` is that along which y came, and then that at y.
  [[nodiscard]] bool correct(Unknowns& y, Unknowns& tangent, int& passes) const;
  [[nodiscard]] bool is_back() const;

  // Any direction but a special one: no tangent is at right angles to it.
  [[nodiscard]] static Unknowns any_direction();

  const Chain& chain_;
  const Pose& X_0n_;
  Line line_;
  bool has_line_;
  Unknowns begin_ = Unknowns::Zero();
  Unknowns begin_tangent_ = Unknowns::Zero();
  Unknowns before_ = Unknowns::Zero();
  Unknowns at_ = Unknowns::Zero();
  Unknowns tangent_ = Unknowns::Zero();
  double step_ = 0;
  double length_ = 0;
  int steps_ = 0;
  bool whole_ = false;
};

}  // namespace armsig::kinematics
