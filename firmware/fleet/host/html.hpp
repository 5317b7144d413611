// SPDX-License-Identifier: MIT
// Parts of the host's pages: no script, nothing from elsewhere.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace armsig::fleet {

// Of the record; none: null.
using Cell = std::optional<std::string>;

// `text` in HTML, nothing of it markup.
[[nodiscard]] std::string escaped(std::string_view text);

// The beginning of a page; `title` is escaped here.
[[nodiscard]] std::string page_head(std::string_view title);

// A cell of a table; `attributes` is markup, with a space before.
[[nodiscard]] std::string cell(const Cell& text, std::string_view attributes = "");

// The number with so many decimals, or nothing.
[[nodiscard]] std::string decimals(const Cell& number, int count);

inline constexpr std::string_view kNumber = " class=n";

}  // namespace armsig::fleet
