// SPDX-License-Identifier: MIT
// Inverse of the identified model (21) for any arm, with bounded work: the joint readings that
// bring frame n to a pose, near a seed (docs/model.md, section 4).
//
// Arms with six joints or more meet all six dimensions of the pose; with more than six, the
// solution nearest to the seed is taken (1 rad counts as 1 m). Arms with fewer meet the position of
// options.p_nP, and the orientation as near as the position, their limits and steps leave them:
// the individual's axes never stand as the orientation asks, however well the nominal ones do.
// InverseSolution says by how much it is missed. Arms whose joints do not move the tip in all three
// directions meet the poses that they can meet whole, and positions beside them by chance.
#pragma once

#include <cstdint>

#include "core/kinematics/forward.hpp"

namespace armsig::kinematics {

enum class Verdict : std::uint8_t {
  kConverged,     // the pose is met, as far as the arm's joints can
  kDegraded,      // it is met, near a singularity: small motions may need large joint motions
  kOutOfReach,    // no reading near the seed brings the arm nearer to the pose
  kJointLimit,    // nearer only by leaving the joint limits
  kStepLimit,     // nearer only by a larger change of a reading than options.max_step
  kNotConverged,  // the iterations were used up
};

struct InverseOptions {
  // The point of frame n, a tool's for instance, whose position counts where not all of a pose can
  // be met.
  Vector3 p_nP = Vector3::Zero();
  // An order below the 1e-9 that is promised, so that another computation of the error agrees.
  double position_tolerance_m = 1e-10;
  double rotation_tolerance_rad = 1e-10;
  // Passes of all loops together, those that lead nowhere too; at least 1. Of a million random
  // poses half a degree away, the slowest took 138, at a fold of the arm.
  int max_iterations = 200;
  // A solution whose regularity (see InverseSolution) is below this is kDegraded.
  double degraded_below = 1e-4;
  bool respect_limits = true;  // those of the chain, if it has any
  // Largest change of each reading from the seed, for one tick: velocity limit times period; 0 or
  // more, infinite for no limit. Empty: none.
  // NOLINTNEXTLINE(readability-redundant-member-init): lets a designated initializer leave it out
  JointVector max_step{};
};

struct InverseSolution {
  // Always finite, inside the joint limits, and within max_step of the seed (a seed outside the
  // limits moves towards them by at most max_step).
  JointVector q;
  Verdict verdict = Verdict::kNotConverged;
  int iterations = 0;             // passes, at most options.max_iterations
  double position_error_m = 0;    // of options.p_nP, where the pose is not met as a whole
  double rotation_error_rad = 0;  // the angle, 0 to pi
  // The manipulability in units of the arm, about 1 at best and 0 at a singularity: regularity.hpp
  // says how it is defined, for any number of joints and whatever way the solution was found.
  double regularity = 1;
};

// `seed` has as many readings as the chain has joints (the present reading in the servo tick).
// A pose that is not met is a verdict, not an error; q is then the nearest that was found. No
// verdict says that a pose is met unless the chain at q is within the tolerances of it: of its
// position, and with six joints or more of the orientation too. Fewer joints that have met the
// position and ran out of iterations while they turned nearer are kNotConverged, with a
// position_error_m within its tolerance.
// Errors: kNotFinite if the pose, the seed or an option holds a NaN or an infinity (but for a step
// without limit); kNotARotation if the pose's R is off a right-handed rotation by more than 1e-9;
// kOutOfReach if the pose is more than 1e6 m away; kOutOfRange if a reading is beyond 1e6 (rad or
// m), a step or tolerance negative, max_iterations below 1, or p_nP beyond 1e6 m.
[[nodiscard]] Result<InverseSolution> inverse(const Chain& chain, const Pose& X_0n,
                                              const JointVector& seed,
                                              const InverseOptions& options = {});

}  // namespace armsig::kinematics
