// SPDX-License-Identifier: MIT
// The play of each joint, from poses that are reached from both of its sides.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::controller {

// From which side each joint comes to a pose: bit i set, its reading grows.
using Sides = std::uint8_t;

[[nodiscard]] inline double side_of(Sides sides, std::size_t joint) {
  return (sides >> joint & 1U) != 0 ? 1 : -1;
}

// How far a target moves when each joint moves by one [m per rad or m].
using Motions = std::array<Vector3, kMaxJoints>;

// Joint i stays behind its motor by half of its play h_i, on the side that it comes from: the
// target is off by -sum_i side_i h_i motion_i. (A drive that overshoots by more than the play ends
// on the other side: h_i is then negative, and as large.) Least squares over all poses; where the
// sides change without regard to the pose, no map of the readings and no gravity looks like that.
class PlayEstimate {
 public:
  explicit PlayEstimate(std::size_t joints = 0) : joints_(joints) {}

  void add(Sides sides, const Motions& motions, const Vector3& residual);

  struct Half {
    double value = 0;  // rad or m
    double sigma = 0;  // infinite: the poses do not tell

    [[nodiscard]] bool is_seen() const { return std::abs(value) > 2 * sigma; }
    // Square of what is there, as far as more than chance shows it.
    [[nodiscard]] double squared() const;
  };
  using Halves = FixedVector<Half, kMaxJoints>;

  // `sigma_m`: of a residual, per axis.
  [[nodiscard]] Halves result(double sigma_m) const;

 private:
  using Matrix = Eigen::Matrix<double, kMaxJoints, kMaxJoints>;

  std::size_t joints_;
  Matrix information_ = Matrix::Zero();
  Eigen::Matrix<double, kMaxJoints, 1> pull_ = Eigen::Matrix<double, kMaxJoints, 1>::Zero();
};

}  // namespace armsig::controller
