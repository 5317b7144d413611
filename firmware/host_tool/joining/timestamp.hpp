// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

namespace armsig::tool {

// Seconds that a time of a log stands for: a number of seconds; HH:MM:SS with a fraction; or the
// same after a date, YYYY-MM-DD or DD.MM.YYYY, and a blank or T (a zone at the end is passed over:
// both logs are of one place). Only differences count. Nothing where it is none of these.
[[nodiscard]] std::optional<double> seconds_of(std::string_view text);

}  // namespace armsig::tool
