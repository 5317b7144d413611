// SPDX-License-Identifier: MIT
// The joint error maps (reading_map.hpp) of all joints in the servo tick, as many joints at
// once as the processor has lanes, from tables of 16 bits.
#pragma once

#include "core/calibration/packed_deflections.hpp"

namespace armsig::calibration {

class ServoMaps {
 public:
  using Values = std::array<double, kMaxJoints>;

  ServoMaps() = default;
  // In place, as all of it is large for a small stack. Precondition: check() accepts `deflections`.
  void set(const PackedDeflections& deflections);

  // What each reading [rad or m] is wrong by; and by how much more, where it changes by one. False
  // if one is not finite, or a thousand periods from its map.
  [[nodiscard]] bool at(const Values& readings, Values& values) const;
  [[nodiscard]] bool at(const Values& readings, Values& values, Values& slopes) const;

  // No value of joint `joint`'s map, and no second derivative of it, is larger.
  [[nodiscard]] double largest(std::size_t joint) const;
  [[nodiscard]] double most_bent(std::size_t joint) const;

 private:
  // The first coefficients once more at the end.
  using Table = std::array<std::int16_t, kKnots + kSplines>;

  struct NoSlopes {};
  template <typename Slopes>
  [[nodiscard]] bool evaluate(const Values& readings, Values& values, Slopes& slopes) const;

  std::size_t joint_count_ = 0;
  alignas(32) Values origin_{};
  alignas(32) Values knots_per_length_{};
  alignas(32) Values sixth_{};  // of a step, rad or m
  std::array<Table, kMaxJoints> tables_{};
};

}  // namespace armsig::calibration
