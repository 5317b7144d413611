// SPDX-License-Identifier: MIT
// A joint that follows another a little, which the arm description does not say: the rows that show
// it look like blunders, and the rest like an arm.
#pragma once

#include <optional>

#include "firmware/host_tool/refinement/candidates.hpp"

namespace armsig::tool {

// The likeliest pair, fitted with all else that `found` has. Nothing where no pair is worth it, or
// where the rows are not explained better with it, fewer of them rejected or those left out
// predicted better.
[[nodiscard]] std::optional<FoundCoupling> find_coupling(const CalibrationLog& log,
                                                         Candidates& candidates,
                                                         const Candidate& found);

}  // namespace armsig::tool
