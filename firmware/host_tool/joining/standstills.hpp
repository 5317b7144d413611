// SPDX-License-Identifier: MIT
// When the arm, or a point, stood still.
#pragma once

#include <span>
#include <vector>

#include "core/base/arm.hpp"
#include "firmware/host_tool/joining/clocks.hpp"
#include "firmware/host_tool/joining/logs.hpp"

namespace armsig::tool {

// Readings of one pose: 0.01 degrees apart at most, or 0.05 mm of a prismatic joint.
[[nodiscard]] bool are_same_readings(const JointVector& a, const JointVector& b,
                                     const JointTypes& types);

// Runs of rows of one pose, in the order of time; one of a single row takes no time.
[[nodiscard]] std::vector<Standstill> standstills_of(std::span<const LoggedPose> poses,
                                                     const Clock& clock, const JointTypes& types);

// Those in which a point may be: `within_s` after their begin to `within_s` before their end. Of a
// log that has but one row a pose, `within_s` about each.
[[nodiscard]] std::vector<Standstill> usable(std::vector<Standstill> standstills, double within_s);

// When points were measured, ascending: the time of each or, of a stream with many more points than
// standstills, the middle of each time in which the point stood still for `within_s`.
[[nodiscard]] std::vector<double> events_of(std::span<const TrackedPoint> points,
                                            const Clock& clock, std::size_t standstills,
                                            double within_s);

}  // namespace armsig::tool
