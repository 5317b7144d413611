// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace armsig::tool {

// As the name of a file to write: standard output, which an AtomicFile writes to directly.
inline constexpr std::string_view kStandardOutput = "-";

}  // namespace armsig::tool
