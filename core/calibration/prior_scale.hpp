// SPDX-License-Identifier: MIT
// The scale of a prior, from the unknowns that have it: MacKay's and the EM fixed point mixed
// (docs/model.md, section 8).
#pragma once

#include <algorithm>
#include <cmath>

#include "core/calibration/engine_data.hpp"

namespace armsig::calibration {

// What is known of a workshop before any row was seen counts as one unknown of the usual size: it
// matters where the rows say little, and a scale found from little alone is too small as often as
// it is too large, but only the former makes promises.
inline constexpr double kUsualUnknowns = 1;

// Updates the scale, `usual` unknowns of unit size counted in; returns how many of the unknowns the
// rows determine.
inline double update_scale(const PriorGroup& group, double& scale, double usual = 0) {
  // Shares of the two fixed points, in logarithms: the one is quick, the other never overshoots.
  constexpr double kQuick = 0.7;
  constexpr double kLeastScale = 1e-6;
  constexpr double kLargestScale = 1e6;
  if (group.unknowns == 0) return 0;
  const double determined = std::clamp(group.unknowns - group.trace / scale, 1e-3, group.unknowns);
  const double squares = group.squares + usual;
  const double quick = std::max(squares, 1e-12) / (determined + usual);
  const double steady = std::max(squares + group.trace, 1e-12) / (group.unknowns + usual);
  scale = std::clamp(std::exp(kQuick * std::log(quick) + (1 - kQuick) * std::log(steady)),
                     kLeastScale, kLargestScale);
  return determined;
}

}  // namespace armsig::calibration
