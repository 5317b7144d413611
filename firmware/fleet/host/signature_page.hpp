// SPDX-License-Identifier: MIT
// What the host says of signatures: of one, and of two of them joint by joint.
#pragma once

#include <string>
#include <string_view>

#include "firmware/fleet/host/page.hpp"

namespace armsig::fleet {

// Where the pages of an arm and of a signature are: these, and the name or the hash.
inline constexpr std::string_view kArm = "/arm/";
inline constexpr std::string_view kSignature = "/signature/";

[[nodiscard]] Answer no_record();

[[nodiscard]] std::string link_to_signature(const std::string& hash);

// What changed between two documents, as a part of a page.
[[nodiscard]] std::string comparison_of(std::string_view before, std::string_view actual);

// The report of one signature: who goes by it, what it was told to be worth, and what it says.
[[nodiscard]] Answer signature_page(const std::string& hash, Database& database);
[[nodiscard]] Answer comparison_page(const std::string& before, const std::string& actual,
                                     Database& database);

}  // namespace armsig::fleet
