// SPDX-License-Identifier: MIT
// Poses of the beginning that are measured once more in the end: whether the arm, its target and
// the sensor still are what they were. It needs no model, so no model can explain a change away.
#pragma once

#include <string_view>

#include "core/base/fixed_vector.hpp"
#include "core/base/pose.hpp"

namespace armsig::controller {

class Repeats {
 public:
  static constexpr std::size_t kMost = 12;

  // Where the target is now, less where it was, at a pose with the last link turned as R_SL; the
  // variance [m^2] of that per axis. Precondition: fewer than kMost were added.
  void add(const Matrix3& R_SL, const Vector3& difference_S, double variance_m2);
  [[nodiscard]] std::size_t count() const { return all_.size(); }

  // Whether a difference is more than one in a thousand is by chance.
  [[nodiscard]] static bool is_beyond_chance(const Vector3& difference, double variance_m2) {
    return difference.squaredNorm() > 16.3 * variance_m2;
  }

  struct Change {
    std::string_view what;  // "target", "sensor", "arm"; empty: nothing changed
    double by_m = 0;        // by the median of the poses that show it
  };
  // A change is what more poses show beyond chance than wrong points, `wrong` of all, would (by
  // four sigma of their number), or what they have in common (in the hand: the target slipped; in
  // the sensor frame: the sensor was moved) beyond six sigma; both more than `least_m`.
  [[nodiscard]] Change change(double wrong, double least_m) const;

 private:
  struct One {
    Vector3 in_sensor = Vector3::Zero();
    Vector3 in_hand = Vector3::Zero();
    double variance_m2 = 0;
  };
  FixedVector<One, kMost> all_;
};

}  // namespace armsig::controller
