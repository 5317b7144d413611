// SPDX-License-Identifier: MIT
#include "firmware/host_tool/simulation/margin.hpp"

#include <fmt/core.h>

#include "core/base/pose.hpp"

namespace armsig::tool {

Read<FixedVector<JointLimits, kMaxJoints>> limits_with_margin(
    const FixedVector<JointLimits, kMaxJoints>& limits, const JointTypes& types,
    const Margin& margin) {
  FixedVector<JointLimits, kMaxJoints> inside;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    const bool turns = types[i] == JointType::kRevolute;
    const double by = turns ? margin.angle_rad : margin.length_m;
    const JointLimits& limit = limits[i];
    if (4 * by >= limit.upper - limit.lower) {
      const double unit = turns ? degrees(1) : 1e3;
      return std::unexpected(
          Problem{turns ? "--margin-deg" : "--margin-mm", 0, 0,
                  fmt::format("{:.6g} leaves less than half of joint {}, {:.6g} to {:.6g}",
                              unit * by, i + 1, unit * limit.lower, unit * limit.upper),
                  "less than a quarter of what the joint moves"});
    }
    inside.push_back({limit.lower + by, limit.upper - by});
  }
  return inside;
}

}  // namespace armsig::tool
