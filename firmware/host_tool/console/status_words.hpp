// SPDX-License-Identifier: MIT
// The reply to `status` (docs/console.md) for a person: what is wrong first, then the arm, its
// model, what is under way. A key that is not known here is shown as it came.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace armsig::tool {

// Whole lines of at most `width` characters, 40 at least.
[[nodiscard]] std::string status_in_words(std::string_view reply, std::size_t width);

}  // namespace armsig::tool
