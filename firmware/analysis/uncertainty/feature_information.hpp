// SPDX-License-Identifier: MIT
// The uncertainty of a signature that came from its sweeps' features, without a refinement.
#pragma once

#include "core/calibration/refined.hpp"

namespace armsig::uncertainty {

// Wraps `signature` as an estimate whose information is that of its features: 4 x 4 (2 x 2) blocks
// of the axis lines, joined with the target that the sweep of the target's link has seen. Features
// of different joints are independent. What no feature says keeps the default prior. Preconditions:
// one feature per joint, X_SL with z along the features' axes. Errors: kSingular when a covariance
// is not positive definite; kCapacityExceeded.
[[nodiscard]] Result<void> from_features(const Signature& signature,
                                         calibration::Refined& estimate);

}  // namespace armsig::uncertainty
