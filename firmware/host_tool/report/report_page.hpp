// SPDX-License-Identifier: MIT
// The page without its data, as the build bundled it (report/web).
#pragma once

#include <string_view>

namespace armsig::tool {

// Holds kDataMarker once, where the data go. Empty where armsig was built without npm.
extern const std::string_view kReportPage;
inline constexpr std::string_view kDataMarker = "@ARMSIG_REPORT_DATA@";

}  // namespace armsig::tool
