// SPDX-License-Identifier: MIT
// What sweeps leave open about an arm that bends: a sweep holds the other joints still, so that
// gravity, gears, joint error maps and axes can stand in for each other in it, and part again
// at other poses.
#pragma once

#include <optional>

#include "core/calibration/refined.hpp"
#include "firmware/host_tool/diagnosis/evidence.hpp"

namespace armsig::tool {

struct UnseenBending {
  double stated_m = 0;     // RMS error at the tool, by the covariance of the estimate
  double expected_m = 0;   // and by what gears, gravity and maps may be, given the same sweeps
  double probability = 0;  // that the arm bends at all, as the sweeps have it
  double factor = 1;       // that sigmas of the estimate need, to come to what is expected
};

// Of an estimate from sweeps alone, over the work volume within `limits`. The arm with
// gears, gravity and maps is estimated from the same rows by the joint Gaussian of everything;
// where it differs from the estimate, and how uncertain it is itself, is what is to be expected.
// `tried`: by a fit that could have taken gravity and maps; where it has none, gears and gravity
// must speak for themselves. Nothing where poses with sweep 0 are among the rows, or the rows are
// few.
[[nodiscard]] std::optional<UnseenBending> judge_bending(
    const Evidence& evidence, const calibration::Refined& estimate,
    const FixedVector<JointLimits, kMaxJoints>& limits, std::size_t tool, bool tried);

}  // namespace armsig::tool
