// SPDX-License-Identifier: MIT
// Whether the whole arm stays clear of its surroundings, at a pose and on the way to it: the origin
// of every link frame with the radius of the links about it, what the hand holds, and the links
// against each other. Readings are effective ones (couplings applied).
#pragma once

#include <cstdint>

#include "core/clearance/surroundings.hpp"

namespace armsig::clearance {

// What is nearer than this to what it must stay clear of is too near.
inline constexpr double kLeastRoom_m = 5e-3;

// What is nearest to its limit.
struct Room {
  double left_m = std::numeric_limits<double>::infinity();  // below zero: it is beyond
  Limit limit = Limit::kMountingPlane;
  std::uint8_t link = 0;   // from 1, base to tip, by its outer end; one more than joints: the hand
  std::uint8_t other = 0;  // kLink: the one that it is near to
  Vector3 p_B = Vector3::Zero();  // the outer end of `link`
};

// The least room at readings `q`, and where each of them is off by `within` at most (empty: none
// is). Two links are not held against each other where the links between are no longer than their
// radii, so that they may always touch: neighbours, and those of a wrist. Nor is the hand against
// links that are nearer along the arm than twice the radii.
// Precondition: a reading a joint.
[[nodiscard]] Room room_at(const DhRows& rows, const Surroundings& around, const JointVector& q,
                           const JointVector& within = {});

// A look along the way that a joint move takes, straight in the readings. It goes on by as much as
// nothing can move farther than there is room (conservative advancement; Mirtich 1996): a way that
// is clear has half of the least room everywhere, not in samples, and the least room at its end. A
// bounded part of it a step.
class WayLook {
 public:
  enum class Says : std::uint8_t { kMore, kClear, kLeaves };

  // kLeastRoom_m is asked for; or less, of an arm that begins with less.
  WayLook() = default;
  explicit WayLook(double least_m) : least_m_(static_cast<float>(least_m)) {}

  // Precondition: the same way in every step of a look, and no step after another answer than
  // kMore. In empty surroundings every way is clear.
  [[nodiscard]] Says step(const DhRows& rows, const Surroundings& around, const JointVector& from,
                          const JointVector& to);
  // The same at once.
  [[nodiscard]] Says whole(const DhRows& rows, const Surroundings& around, const JointVector& from,
                           const JointVector& to);
  // How much of the way is clear, up to 1.
  [[nodiscard]] double part() const { return static_cast<double>(part_); }
  // After kLeaves: what leaves.
  [[nodiscard]] const Room& room() const { return room_; }

 private:
  float least_m_ = static_cast<float>(kLeastRoom_m);
  float part_ = 0;
  Room room_;
};

// How far joint `joint` of an arm at `q` may go to either side, inside `limits`, the others held,
// before something comes too near; to a 4096th of the way to the limit. `q` and the answer are what
// the couplings apply to. Where `q` itself is too near to something that reading alone is left.
[[nodiscard]] JointLimits free_readings(const DhRows& rows, const JointCouplings& couplings,
                                        const Surroundings& around, const JointVector& q,
                                        std::size_t joint, const JointLimits& limits);

}  // namespace armsig::clearance
