// SPDX-License-Identifier: MIT
// What the constraints of the encoder-referenced circle and line remove, as a diagnostic of the
// encoder: gear ratio, eccentricity, scale.
#pragma once

#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

struct EncoderRatio {
  double ratio = 1;  // |A| / |B| (revolute), |u| (prismatic) of the unconstrained fit; ideally 1
  double sigma = 0;  // its 1 sigma, where the points' covariances are as given
};

// Precondition: statistics.motion has full rank and its motion is not zero.
[[nodiscard]] EncoderRatio encoder_ratio(const SweepStatistics& statistics);

}  // namespace armsig::features
