// SPDX-License-Identifier: MIT
// The pages of one arm and of its signatures: /arm/NODE, /signature/HASH, /compare/HASH/HASH.
#pragma once

#include <string_view>

#include "firmware/fleet/host/page.hpp"

namespace armsig::fleet {

[[nodiscard]] bool is_of_one_arm(std::string_view path);
// Precondition: is_of_one_arm(path).
[[nodiscard]] Answer answer_of_one_arm(std::string_view path, Database& database);

}  // namespace armsig::fleet
