// SPDX-License-Identifier: MIT
// What of a program, or of a table of poses, is left as it is, for a person and for a program.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host_tool/programs/program.hpp"

namespace armsig::tool {

// `place`: what the numbers count, "line" or "pose".
// Each of those that are left, or each remark.
[[nodiscard]] std::vector<std::string> left_in_words(const std::vector<LeftAsItIs>& left,
                                                     std::string_view place);
[[nodiscard]] std::vector<std::string> remarks_in_words(const std::vector<LeftAsItIs>& left,
                                                        std::string_view place);

// Both, where many have one reason at once: "lines 9 to 14, 20: P[1] to P[8]: ...".
[[nodiscard]] std::vector<std::string> left_in_runs(const std::vector<LeftAsItIs>& left,
                                                    std::string_view place);

// Without remarks.
[[nodiscard]] std::size_t count_left(const std::vector<LeftAsItIs>& left);

}  // namespace armsig::tool
