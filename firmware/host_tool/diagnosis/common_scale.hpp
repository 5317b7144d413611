// SPDX-License-Identifier: MIT
// Whether what looks like many small deviations of an arm is one factor on all its lengths.
#pragma once

#include <optional>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

// One factor on all positions against a deviation at every axis.
struct CommonScale {
  double factor = 1;    // what was seen against the drawing
  double before_m = 0;  // RMS shift of the axes from the drawing without the factor
  double after_m = 0;   // and with it
  double evidence = 0;  // natural logarithm of the ratio of the likelihoods, for the factor
  Evidence undone;      // the rows with the factor taken off
  NearFit fit;          // to them
};

// `fit` is that of `evidence` without the factor. The shifts of the axes are taken as normal, of a
// standard deviation that the shifts themselves tell, about that of a workshop (Student's
// distribution): where they shrink together under one factor far more than the one dimension of
// many that it takes, the factor is what there is. It is looked for from `start` on. Nothing where
// no fit is found, or where the shifts are too small for any factor to be evident.
[[nodiscard]] std::optional<CommonScale> common_scale(const Evidence& evidence, const NearFit& fit,
                                                      const ArmLimits& limits, double start = 1);

}  // namespace armsig::tool
