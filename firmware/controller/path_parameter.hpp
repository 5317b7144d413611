// SPDX-License-Identifier: MIT
// The path parameter s of a move, tick by tick: by the minimum-jerk plan, and after a halt by the
// shortest braking that keeps the limits of the joints.
//
// A joint at q(s) has the acceleration q'' s'^2 + q' s'' (Bobrow, Dubowsky and Gibson, Time-optimal
// control of robotic manipulators along specified paths, 1985). The joint that has least left gives
// the bound of s''.
#pragma once

#include <array>
#include <cstddef>

namespace armsig::controller {

// The course of a move over its duration (Flash and Hogan 1985): s from 0 to 1 for part in [0, 1],
// with velocity and acceleration zero at both ends.
[[nodiscard]] constexpr double minimum_jerk(double part) {
  return part * part * part * (10 + part * (-15 + 6 * part));
}
inline constexpr double kPeakSpeed = 1.875;               // of s, per duration
inline constexpr double kPeakAcceleration = 5.773502692;  // of s, per duration squared
inline constexpr double kPeakJerk = 60;                   // of s, per duration cubed

// The jerk of the shortest minimum-jerk move that reaches both the speed v and the acceleration a
// of a joint, per a^2 / v.
inline constexpr double kJerkOfFullSpeed =
    kPeakJerk / kPeakSpeed * (kPeakSpeed / kPeakAcceleration) * (kPeakSpeed / kPeakAcceleration);

// A path in parts of equal s, from 0 to 1.
inline constexpr std::size_t kPathParts = 10;
[[nodiscard]] std::size_t path_part(double s);

// How the joints of a move share their limits with its path: the largest of each over all joints. a
// and v are a joint's limits of acceleration and speed. In few bytes: every command holds one.
struct PathShares {
  struct Part {
    float slope = 0;      // |dq/ds| / a
    float curvature = 0;  // |d2q/ds2| / a
  };
  std::array<Part, kPathParts> parts{};
  double full_speed = 0;  // |dq/ds| v / a^2, of the whole path

  // Of one joint between two places of the path. Precondition: limits above zero.
  void add(double s_from, double s_to, double slope, double curvature, double speed,
           double acceleration);
};

// What s may do after a halt, per second: at the speed s' the braking -s'' is at most `planned`, or
// what curvature leaves of the slope's share where that is more.
struct BrakingLimits {
  PathShares shares;
  double planned = 0;  // s'' that the shortest plan of the path comes to
  double jerk = 0;

  [[nodiscard]] double braking_in(std::size_t part, double speed) const;
};

// Of a path that is planned to last `duration_s` at full pace. The jerk is that of this plan, or of
// the joints' shortest move at full speed where that is more.
[[nodiscard]] BrakingLimits braking_limits(const PathShares& shares, double duration_s);

// After a halt s is never ahead of the plan, does not fall, and stands after a bounded number of
// ticks: no later than the plan ends. Proof: the steps of the plan keep the same bounds and end at
// rest; the braking is the one of smallest steps that can still end at rest within them.
class PathParameter {
 public:
  // A move of `duration_s` begins, told once a `period_s`.
  void begin(double duration_s, double period_s);
  // From the next tick on; said again it changes nothing.
  void brake() { braking_ = true; }
  // s of the next tick, in [0, 1]; `limits` are those of the move. Precondition: not at_rest().
  double advance(const BrakingLimits& limits);
  // The plan is over, or the braking.
  [[nodiscard]] bool at_rest() const { return at_rest_; }
  // Until the move is over; of a braked one at most.
  [[nodiscard]] double left_s() const { return left_s_; }

 private:
  void advance_braking(const BrakingLimits& limits);
  [[nodiscard]] double most_braking(const BrakingLimits& limits) const;

  double duration_s_ = 0;
  double period_s_ = 0;
  double left_s_ = 0;
  double s_ = 0;
  double step_ = 0;    // of s in the last tick
  double growth_ = 0;  // of the step in the last tick
  bool braking_ = false;
  bool at_rest_ = true;
};

}  // namespace armsig::controller
