// SPDX-License-Identifier: MIT
// SHA-256 (FIPS 180-4), by which documents are named.
#pragma once

#include <string>
#include <string_view>

namespace armsig::fleet {

// In hexadecimal, small letters.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace armsig::fleet
