// SPDX-License-Identifier: MIT
// What the rows alone determine of the unknowns, without the priors of the fit.
#pragma once

#include <span>

#include "core/calibration/refined.hpp"

namespace armsig::calibration {

// Makes `information` that of priors so wide that they leave alone what rows determine.
void set_wide_priors(const Layout& layout, SquareRootFactor& information);

// What the rows say about the unknowns of `estimate.layout`, linearised at the estimate.
struct RowsAlone {
  SquareRootFactor information;  // with wide priors
  // Largest motion of each joint in the rows, and largest distance of a target from its axis then.
  std::array<double, kMaxJoints> motion{};
  std::array<double, kMaxJoints> radius_m{};
};

// Of the rows that are fitted and were not rejected, each measured number to `sigma_m` [m]. `alone`
// may not be part of `estimate`. Preconditions: sigma_m > 0; targets and receivers of the log
// exist; `outcomes` is as long as the log.
void gather_rows(std::span<const Observation> log, std::span<const RowOutcome> outcomes,
                 const Receivers& receivers, double sigma_m, const Refined& estimate,
                 RowsAlone& alone);

// Names in `estimate.undetermined` the unknowns that the rows leave where the wide prior has them:
// those whose sigma has kept more than kOpenShare of it. A scale is never among them.
inline constexpr double kOpenShare = 0.2;
void name_undetermined(const RowsAlone& alone, Refined& estimate);

// 1 sigma of unknown `index`. Precondition: the factor is regular.
[[nodiscard]] double parameter_sigma(const SquareRootFactor& information, std::size_t index);

}  // namespace armsig::calibration
