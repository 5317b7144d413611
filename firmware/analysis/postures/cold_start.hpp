// SPDX-License-Identifier: MIT
// Inverse kinematics without a seed: all distinct solutions of the identified chain.
#pragma once

#include "core/kinematics/inverse.hpp"
#include "firmware/analysis/postures/closed_form.hpp"
#include "firmware/analysis/postures/posture_list.hpp"

namespace armsig::kinematics {

// All postures that meet the pose, each once: those inside the limits first; among them those that
// meet the whole pose, then those that miss the orientation by no more than 0.02 rad beyond the
// best of all (an arm with fewer than six joints may meet the position alone in another posture);
// then nearest to `reference` (largest change of a reading; empty: the middle of the limits, or
// zero). Where more than kMaxSolutions meet it, the first of this order. Readings of revolute
// joints are chosen, among those that differ by whole turns, inside the limits and nearest to the
// reference; one beyond its limit by rounding is at the limit. Solutions nearer than 1e-4 rad or m
// are one, next to a fold those nearer than 3e-4, and so are those that joints can move between
// without moving frame n. Of these, and of seven joints, one solution is listed for each stretch of
// the motion inside the limits: the nearest to the reference.
//
// Arms of the two common designs are started from their closed form (docs/model.md, section 4).
// Next to a singularity, and for other arms that posture_search.hpp knows, the postures are
// searched on the chain as it is; those of other six-axis arms, and beside folds, are followed
// along curves from a fixed set of starts (motion_curve.hpp); all other arms are started from such
// a set alone. Empty if nothing meets the pose. options.max_step and options.respect_limits are not
// used. Limits may be infinite: such a joint is looked for within a turn, or an arm's length of
// travel, and its middle is that of the range. `form` is kOther or that of this chain. Errors:
// those of inverse(), the reference in place of the seed.
[[nodiscard]] Result<Solutions> cold_start(const Chain& chain, const ClosedForm& form,
                                           const Pose& X_0n, const JointVector& reference = {},
                                           const InverseOptions& options = {});

// "lefty above noflip", ...; "solution" where the arm has no named postures.
[[nodiscard]] const char* name(const NamedSolution& solution);

}  // namespace armsig::kinematics
