// SPDX-License-Identifier: MIT
// The constants of a pseudo Denavit-Hartenberg chain (21), prepared for the servo loop.
//
// Near-parallel axes give rows whose d is hundreds of metres and cancels in the product. A frame
// may slide along its own z axis without changing the product, so make_chain moves every frame back
// to where the arm is: afterwards no constant is longer than the arm, and no digit is lost to the
// cancellation. A link is then
//   Rot(z, theta) Trans(x, y, z) Rot(x, alpha).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/arm.hpp"

namespace armsig::kinematics {

// As many lanes as a register has in any build for the processor. The flags of one build don't
// count: a chain passes between a program and the library, which may be built with others.
#ifdef __arm__
inline constexpr std::size_t kCopies = 1;
#else
inline constexpr std::size_t kCopies = 4;
#endif

// A constant written out as often as a register has lanes, so that the kernel need not spread it.
struct Broadcast {
  alignas(kCopies * sizeof(double)) std::array<double, kCopies> copies;

  Broadcast& operator=(double value) {
    copies.fill(value);
    return *this;
  }
  // NOLINTNEXTLINE(google-explicit-constructor): reads like the number that it is
  operator double() const { return copies[0]; }
};

// Constants per joint, base to tip; lengths in metres, angles in radians. Entries beyond
// joint_count are zero.
struct Chain {
  using Constants = std::array<Broadcast, kMaxJoints>;

  alignas(32) std::array<double, kMaxJoints> theta{};  // added to the reading of a revolute joint
  // All bits set for a revolute joint, none for a prismatic one: masks readings at no cost.
  alignas(32) std::array<std::int64_t, kMaxJoints> revolute_bits{};
  Constants x{};  // translation of the link after Rot(z, theta)
  Constants y{};
  Constants z{};  // the reading of a prismatic joint is added to it
  Constants cos_alpha{};
  Constants sin_alpha{};
  std::array<bool, kMaxJoints> revolute{};
  std::size_t joint_count = 0;
  bool has_prismatic = false;
  // Three to five joints that move the tip in all directions: they meet a position, and the
  // orientation as near as that leaves them (position_first.hpp).
  bool position_first = false;
  // The unit of lengths where they are compared with angles: two fifths of the stretched arm, with
  // the strokes that its limits allow. 1 for an arm without any length.
  double length = 1;
  FixedVector<JointLimits, kMaxJoints> limits;  // of the readings; empty: none
};

// The chain of 1 to kMaxJoints `rows`; `limits` is empty or has one entry per row with
// lower <= upper (else a mistake of the caller). Finite rows are the caller's duty.
[[nodiscard]] Chain make_chain(const DhRows& rows,
                               const FixedVector<JointLimits, kMaxJoints>& limits = {});

}  // namespace armsig::kinematics
