// SPDX-License-Identifier: MIT
// What the host says of signatures: of one, and of two of them joint by joint.
#pragma once

#include <string>
#include <string_view>

#include "firmware/fleet/host/html.hpp"
#include "firmware/fleet/host/page.hpp"

namespace armsig::fleet {

// Where the pages of an arm and of a signature are: these, and the name or the hash.
inline constexpr std::string_view kArm = "/arm/";
inline constexpr std::string_view kSignature = "/signature/";

[[nodiscard]] Answer no_record();

[[nodiscard]] std::string link_to_signature(const std::string& hash);

// The accuracy of one signature, as the record has it of that signature; a predicted error is shown
// with its region alone.
struct Figures {
  Cell predicted_mm;
  Cell region;
  Cell validation_mm;
  Cell poses;
  Cell air_c;
};
inline constexpr std::string_view kFigureHeads =
    "<th class=n>predicted tool error, mm RMS<th>over<th class=n>validation, mm RMS<th "
    "class=n>poses<th class=n>air, \u00b0C";
[[nodiscard]] std::string figures(const Figures& of);
// A region of a predicted tool error.
[[nodiscard]] std::string in_words(std::string_view region);

// What changed between two documents, as a part of a page.
[[nodiscard]] std::string comparison_of(std::string_view before, std::string_view actual);

// The report of one signature: who goes by it, what it was told to be worth, and what it says.
[[nodiscard]] Answer signature_page(const std::string& hash, Database& database);
[[nodiscard]] Answer comparison_page(const std::string& before, const std::string& actual,
                                     Database& database);

}  // namespace armsig::fleet
