// SPDX-License-Identifier: MIT
// What the data determined, and how well: the last step of a refinement.
#pragma once

#include "core/refinement/problem.hpp"

namespace armsig::refinement {

// 1 sigma of unknown `index`. Precondition: the factor is regular.
[[nodiscard]] double parameter_sigma(const SquareRootFactor& information, std::size_t index);

// 3 x 3 covariance of three neighbouring unknowns, such as a target. Same precondition.
[[nodiscard]] Matrix3 covariance_of_three(const SquareRootFactor& information, std::size_t first);

// Names the unknowns that the data leave where the prior put them: those whose sigma has kept more
// than kOpenShare of its prior.
// Returns, per unknown, whether it is among them.
[[nodiscard]] std::array<bool, kMaxParameters> find_undetermined(const Problem& problem,
                                                                 const Prior& prior,
                                                                 Refined& refined);
inline constexpr double kOpenShare = 0.2;

// Scales the covariance by what the residuals say of the noise, and hands the targets their share
// of it. `weighted_squares`: sum of the squared residuals over their assumed variances.
void settle_covariance(double weighted_squares, Refined& refined);

}  // namespace armsig::refinement
