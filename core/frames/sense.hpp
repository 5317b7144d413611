// SPDX-License-Identifier: MIT
// Does the arm turn the way its drawing says? A joint whose reading counts backwards, or a sensor
// with left-handed coordinates, gives features that fit perfectly and a model of another arm.
//
// The axes of the drawing at the signature configuration are laid over the identified ones. If they
// do not match, the fewest reversed joints that make them match are looked for.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/subset.hpp"
#include "core/frames/alignment.hpp"

namespace armsig::frames {

// A match: every direction within 20 degrees, every line within 20 % of the size of the arm. Wide,
// because the zero of a real encoder may be some tens of degrees from the drawing's. To refuse an
// arm, the axes with joints reversed must match twice as well: with all zeros wrong by up to 60
// degrees, none of the known arms was then refused in 100 trials each.
inline constexpr double kMatchAngleRad = radians(20.0);
inline constexpr double kMatchFraction = 0.2;

enum class SenseVerdict : std::uint8_t {
  kAgrees,          // the axes match as drawn, or cannot tell (one joint, two crossing axes, ...)
  kJointsReversed,  // they match with some joints reversed
  kSensorMirrored,  // they match with all measured positions reflected
  kNoMatch,         // the drawing is of another arm, or its zeros are far from this arm's
};

struct SenseCheck {
  SenseVerdict verdict = SenseVerdict::kAgrees;
  FixedVector<bool, kMaxJoints> reversed;  // per joint; all false unless kJointsReversed
  double angle_rad = 0;                    // greatest misalignment as drawn, nothing reversed
  double distance_m = 0;
};

// Compares the drawing with the identified axes (in any frame). A joint that counts backwards is
// looked for both with the drawing at minus its reading (negated as a whole) and at the reading as
// it is (negated about the signature configuration).
//
// What the axes alone cannot tell apart: one reversed joint and a mirrored sensor, where the arm is
// symmetric (SCARA: the prismatic joint is named); a reversed joint, and a zero of the joint before
// it that is half a turn from the drawing's (the reversed joint is named).
//
// A bounded step at a time: a step of an alignment, or a look at one explanation. `drawing` and
// `configuration` must outlive it. Preconditions: one reading and one identified line a joint, of
// the drawing's types.
class SenseChecking {
 public:
  SenseChecking(const Arm& drawing, const JointVector& configuration, const AxisLines& identified);

  // False if nothing is left to do.
  bool step();
  // Precondition: step() has returned false.
  [[nodiscard]] const SenseCheck& result() const { return check_; }

 private:
  // What the identified axes are compared with: the drawing as it is; the drawing with some joints
  // reversed, at minus their readings or at the readings as they are; a mirror image.
  enum class Explanation : std::uint8_t { kAsDrawn, kNegated, kReversed, kMirrored };

  // To the next explanation; false if there is none.
  [[nodiscard]] bool advance();
  // Begins to lay its axes over each other, unless it can't match.
  void begin();
  // Whether the alignment settles the verdict.
  [[nodiscard]] bool judge();

  const Arm& drawing_;
  const JointVector& configuration_;
  AxisLines identified_;
  AxisLines drawn_;  // of the explanation
  Explanation explanation_ = Explanation::kAsDrawn;
  Subset reversed_ = 0;  // of the joints
  std::optional<Aligning> aligning_;
  SenseCheck check_;
};

}  // namespace armsig::frames
