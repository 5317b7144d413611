// SPDX-License-Identifier: MIT
// Angles as tables of parameters spell them: pi/2, -3*pi/4, 0.5 pi.
#pragma once

#include <optional>
#include <string_view>

namespace armsig::tool {

// Whether `text` speaks of pi (or the Greek letter) at all.
[[nodiscard]] bool names_pi(std::string_view text);

// [-+] [number [*]] pi [/ number] or pi [* number] [/ number], blanks between; nothing where `text`
// is anything else.
[[nodiscard]] std::optional<double> parse_pi(std::string_view text);

}  // namespace armsig::tool
