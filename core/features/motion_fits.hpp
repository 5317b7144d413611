// SPDX-License-Identifier: MIT
// The circle or line that a joint moves its target on, from the statistics of a sweep, by either
// method. Each fills in the triad of a feature, its radius (0 of a line), and the covariance, where
// the points' covariances are as given; after an error the feature has no meaning.
//
// Functions of their own, as are others on the way to a feature: what a fit keeps on the stack
// stands there while it is computed only.
#pragma once

#include "core/base/error.hpp"
#include "core/features/feature.hpp"
#include "core/features/sweep_statistics.hpp"

namespace armsig::features {

// Whether there is room for the paper's fit: in an image that never asks for it there is not, and
// asking is kUnsupported.
#ifdef ARMSIG_NO_PAPER_FIT
inline constexpr bool kHasPaperFit = false;
#else
inline constexpr bool kHasPaperFit = true;
#endif

// The encoder-referenced circle: p = c + A cos t + B sin t with |A| = |B|, A perpendicular to B.
//
// The unconstrained model is linear (9 unknowns) and its triangular factor says everything that the
// points said. The circle (7 unknowns) of greatest likelihood is found on that factor alone: in the
// closed form of orthogonal Procrustes where the points are equally good in all directions, by
// Gauss-Newton from there where not. The cost does not grow with the sweep.
// Errors: kSingular (the readings do not determine a circle), kNotConverged.
[[nodiscard]] [[gnu::noinline]] Result<void> encoder_circle(const MotionStatistics& statistics,
                                                            JointFeature& feature);

// The encoder-referenced line: p = c + u t with |u| = 1, likewise.
// Errors: kSingular (the readings do not determine a line), kNotConverged.
[[nodiscard]] [[gnu::noinline]] Result<void> encoder_line(const MotionStatistics& statistics,
                                                          JointFeature& feature);

// The paper's path: the circle from (13) and (14), the line of translation, completed by what only
// the joint reading tells: the positive sense (section 3.2.2) and where the target is at the origin
// reading. The paper takes the direction of the first target (17); here the reading makes all
// targets vote. The covariances are first-order, for noise that is alike in all directions of the
// plane (circle).
// Errors: kSingular.
[[nodiscard]] [[gnu::noinline]] Result<void> paper_circle(const SweepStatistics& statistics,
                                                          JointFeature& feature);
[[nodiscard]] [[gnu::noinline]] Result<void> paper_line(const SweepStatistics& statistics,
                                                        JointFeature& feature);

}  // namespace armsig::features
