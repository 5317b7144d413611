// SPDX-License-Identifier: MIT
// A joint that follows another one by a share that the arm description does not state: found by how
// the nearest arm misses the rows.
#pragma once

#include <optional>

#include "firmware/host_tool/diagnosis/near_fit.hpp"

namespace armsig::tool {

struct UnstatedCoupling {
  std::size_t joint = 0;
  std::size_t from = 0;
  double ratio = 0;   // of the reading of `from`, in the convention of the arm description
  Evidence undone{};  // with that coupling taken into the readings
  NearFit fit{};      // of it
};

// The coupling of two joints of one type that explains most. Nothing where no two joints moved.
[[nodiscard]] std::optional<UnstatedCoupling> find_unstated_coupling(const Evidence& evidence,
                                                                     const ArmLimits& limits);

}  // namespace armsig::tool
