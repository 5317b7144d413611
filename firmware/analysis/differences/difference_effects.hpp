// SPDX-License-Identifier: MIT
// What every deviation of an arm from its drawing does to the tool, over the whole work volume.
#pragma once

#include "core/calibration/readings.hpp"
#include "firmware/analysis/differences/axis_deviations.hpp"
#include "firmware/analysis/differences/bends.hpp"

namespace armsig::differences {

// What moves the tool of an arm from where its drawing has it: the deviations of a joint, in their
// order, the errors of its reading, its map, and deflection by gravity to it.
enum class Cause : std::uint8_t {
  kTiltX,
  kTiltY,
  kShiftX,
  kShiftY,
  kZero,
  kScale,
  kOnceATurn,
  kTwiceATurn,
  kMap,
  kGravity,
};
inline constexpr std::size_t kCauses = 10;

// The chain of axis_deviations() with a tool.
struct DeviatingChain {
  FixedVector<DrawnAxis, kMaxJoints> axes;
  DeviationValues values{};            // a zero is that of the encoder's reading zero
  calibration::ReadingModel readings;  // couplings of the drawing, corrections of the arm
  Pose X_SD;
  Vector3 p_T = Vector3::Zero();  // the tool in the frame of the last axis, which has turned
  Bendings bendings;              // what either gives way by beyond its readings
};

// The frame of the last axis, turned with its joint, in the sensor frame at effective readings;
// nothing gives way.
[[nodiscard]] Pose hand_pose(const DeviatingChain& chain, const JointVector& effective);

// Base and tool of the drawing, as they fit the tool of the arm best over `count` configurations.
struct FittedBase {
  Pose X_SD;
  Vector3 p_T = Vector3::Zero();  // as DeviatingChain::p_T
};
[[nodiscard]] FittedBase fitted_base(const DeviatingChain& chain,
                                     const FixedVector<JointLimits, kMaxJoints>& limits,
                                     int count = 1000);

struct Effect {
  double rms_m = 0;   // of what it does to the tool by itself
  double adds_m = 0;  // its part along what all do together
};

struct Effects {
  std::array<Effect, kMaxJoints * kCauses> of{};  // joint by joint
  // Of the drawing from the arm, base and tool fitted: the sum of all adds_m.
  double total_rms_m = 0;
  Bend largest;  // absolute values
};

// Over `count` configurations of the work volume. The drawing has base and tool fitted to the tool
// of the arm, by least squares; from there to the arm leads the straight path of all deviations, of
// base and tool. What a cause does at a configuration is the integral of its derivative along the
// path, less what base and tool take of it (an oblique projection, see docs/differences.md): a
// vector, and the sum of these vectors is the displacement of the tool between drawing and arm.
// Precondition: limits for every joint.
[[nodiscard]] Effects difference_effects(const DeviatingChain& chain,
                                         const FixedVector<JointLimits, kMaxJoints>& limits,
                                         int count = 1000);

}  // namespace armsig::differences
