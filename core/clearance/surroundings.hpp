// SPDX-License-Identifier: MIT
// What a whole arm stays clear of: the plane that its base is bolted to, the floor, a box, and its
// own other links. Frame B is the base, frame 0 of the nominal model.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "core/base/arm.hpp"
#include "core/base/pose.hpp"

namespace armsig::clearance {

enum class Limit : std::uint8_t { kMountingPlane, kFloor, kBox, kLink };

// Free where normal_B . p_B >= offset_m.
struct HalfSpace {
  Vector3 normal_B = Vector3::UnitZ();
  double offset_m = 0;
  Limit limit = Limit::kMountingPlane;
};

// By default there is nothing around, and links are lines that do not meet.
struct Surroundings {
  FixedVector<HalfSpace, 2> planes;
  Vector3 lower_B = Vector3::Constant(-std::numeric_limits<double>::infinity());  // of the box
  Vector3 upper_B = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 foot_B = Vector3::Zero();  // where the first link begins: below the base, on the floor
  // Link i is a capsule of this radius from the origin of frame i - 1 to that of frame i. Zero: no
  // link is held against another.
  double link_radius_m = 0;
  // What the flange carries is in a ball of this radius about the last origin.
  double hand_m = 0;

  [[nodiscard]] bool has_box() const {
    return lower_B.array().isFinite().any() || upper_B.array().isFinite().any();
  }
  [[nodiscard]] bool are_empty() const {
    return planes.empty() && !has_box() && !(link_radius_m > 0);
  }
};

// How an arm is bolted down. The plane z = 0 of frame B is the mounting plane, and the arm is on
// the side of it to which d of the first joint leads (on that of z where d is zero).
struct Mounting {
  enum class On : std::uint8_t { kFloor, kCeiling, kWall, kTilted };
  On on = On::kFloor;
  Vector3 tilted_gravity_B = -Vector3::UnitZ();  // kTilted: which way gravity pulls; a unit vector
  // How far below the origin of frame B the floor is, along gravity: of a pedestal, or of the hall.
  std::optional<double> floor_m = {};
  std::optional<double> link_radius_m = {};
};

// Which way gravity pulls. On the floor from the arm to the mounting plane, on the ceiling away
// from that plane, on a wall along -x of frame B.
[[nodiscard]] Vector3 gravity_B(const Arm& arm, const Mounting& mounting);

// 5 % of the length of all links but the first, slides at their longest.
[[nodiscard]] double usual_link_radius_m(const Arm& arm);

// Mounting plane, floor and links of an arm that is mounted so. Where the arm stands and floor_m is
// told, the base is on a pedestal: the floor takes the place of the mounting plane, and the first
// link begins on the floor. An arm on a wall or a ceiling keeps its mounting plane, and has the
// floor besides. No box, nothing in the hand. Precondition: a joint at least.
[[nodiscard]] Surroundings surroundings_of(const Arm& arm, const Mounting& mounting);

}  // namespace armsig::clearance
