// SPDX-License-Identifier: MIT
// Poses of the beginning that are measured once more in the end: whether the arm, its target and
// the sensor still are what they were. It needs no model, so no model can explain a change away.
#pragma once

#include <string_view>

#include "core/base/arm.hpp"
#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::controller {

class Repeats {
 public:
  static constexpr std::size_t kMost = 12;
  // How the target moves by one unit of each parameter of what may have changed.
  using Motions = FixedVector<Vector3, kMaxJoints>;

  // Where the target is now, less where it was, at a pose with the last link turned as R_SL; the
  // variance [m^2] of that per axis; and how it moves there when a load bends the joints, each by
  // its own compliance. Precondition: fewer than kMost were added, all with as many motions.
  void add(const Matrix3& R_SL, const Vector3& difference_S, double variance_m2,
           const Motions& by_load = {});
  [[nodiscard]] std::size_t count() const { return all_.size(); }

  // Whether a difference is more than one in a thousand is by chance.
  [[nodiscard]] static bool is_beyond_chance(const Vector3& difference, double variance_m2) {
    return difference.squaredNorm() > kOneInThousand * variance_m2;
  }

  struct Change {
    std::string_view what;  // "target", "sensor", "load", "arm"; empty: nothing changed
    double by_m = 0;        // RMS over the poses; "arm": the median of those that show it
  };
  // A change is what one cause explains of all differences beyond five sigma of chance (the target
  // slipped: the same in the hand's frame; the sensor was moved: the same in its own; a load: as it
  // bends the joints), or what more poses show beyond chance than wrong points, `wrong` of all,
  // would, by four sigma of their number; both more than `least_m`.
  [[nodiscard]] Change change(double wrong, double least_m) const;

 private:
  static constexpr double kOneInThousand = 16.3;  // chi-square of three

  struct One {
    Vector3 difference_S = Vector3::Zero();
    double variance_m2 = 0;
    Motions by_target = {};
    Motions by_sensor = {};
    Motions by_load = {};

    // How far the target is, by these parameters of a cause.
    [[nodiscard]] Vector3 moved(Motions One::* cause, const numerics::Column& by) const;
  };
  using Numbers = FixedVector<double, kMost>;  // one a pose
  // What one cause explains.
  struct Explained {
    double beyond = 0;  // chance: of the sum of squares it takes away, by so much
    double by_m = 0;
    std::size_t left = 0;  // poses that are beyond chance still
  };
  [[nodiscard]] bool solve(Motions One::* cause, double limit, const Numbers& squares,
                           numerics::Column& by) const;
  [[nodiscard]] Explained explained_by(Motions One::* cause) const;

  FixedVector<One, kMost> all_;
};

}  // namespace armsig::controller
