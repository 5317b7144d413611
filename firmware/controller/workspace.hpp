// SPDX-License-Identifier: MIT
// Whether the arm of the drawing stays in the workspace box, at a pose and on the way to it.
#pragma once

#include <cstdint>

#include "firmware/controller/configuration.hpp"
#include "firmware/controller/refinement.hpp"

namespace armsig::controller {

// The R5F has no memory for that either: its configuration may have no box.
inline constexpr bool kMayBound = kMayRefine;

// What is nearer to a side of the box than this is outside.
inline constexpr double kLeastRoom_m = 5e-3;

// How far [m] the arm is from the nearest side, and which joint moves what is there; below zero: it
// is beyond. `q`: effective readings. Precondition: there is a box.
struct Room {
  double left_m = 0;
  std::size_t joint = 0;
};
[[nodiscard]] Room room_at(const Configuration& configuration, const JointVector& q);

// A look along the way that a joint move takes, straight in the readings. It goes on by as much as
// nothing can move farther than there is room (conservative advancement; Mirtich 1996): a way that
// is clear has half of kLeastRoom_m everywhere, not in samples. A bounded part of it a step: six
// places, some 40,000 instructions of a microcontroller.
class WayLook {
 public:
  enum class Says : std::uint8_t { kMore, kClear, kLeaves };

  // Precondition: the same way in every step of a look, and no step after another answer than
  // kMore. Without a box every way is clear.
  [[nodiscard]] Says step(const Configuration& configuration, const JointVector& from,
                          const JointVector& to);
  // How much of the way is clear, up to 1.
  [[nodiscard]] double part() const { return static_cast<double>(part_); }
  // After kLeaves: the one that moves what leaves.
  [[nodiscard]] std::size_t joint() const { return joint_; }

 private:
  float part_ = 0;
  std::uint8_t joint_ = 0;
};

}  // namespace armsig::controller
