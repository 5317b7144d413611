// SPDX-License-Identifier: MIT
// Two targets measured in the same sweep: what each says about the axis, combined.
#pragma once

#include "core/features/feature.hpp"

namespace armsig::features {

// Information-weighted: the axis line (prismatic: the direction) of b enters a as a measurement
// with the covariance that b states; the centre, radius and radial reference stay those of a's
// target, moved as far as the better axis moves them. Counts and ranges of readings cover both.
// Preconditions: features of the same joint, with covariances that are not zero.
[[nodiscard]] JointFeature fuse(const JointFeature& a, const JointFeature& b);

}  // namespace armsig::features
