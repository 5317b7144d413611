// SPDX-License-Identifier: MIT
// The words of --correct.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/refinement/refinement_run.hpp"

namespace armsig::tool {

// `method` as asked for: "refined", or one still to be chosen, finds them. `has_receivers`: the
// sensor measures ranges, whose offsets can be found.
[[nodiscard]] Read<FurtherUnknowns> parse_corrections(const std::vector<std::string>& words,
                                                      std::string_view method, bool has_receivers);

// As --correct wants them.
[[nodiscard]] std::string corrections_in_words(const calibration::ReadingTerms& terms);

}  // namespace armsig::tool
