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

// The beginning of a page, up to its main part; `title` is escaped here.
[[nodiscard]] std::string page_head(std::string_view title);

// The beginning of a table that may be wider than the page, which ends with "</table></div>": the
// keyboard scrolls it too. `what` it has is escaped here; `attributes` are the table's.
[[nodiscard]] std::string table_head(std::string_view what, std::string_view attributes = "");

// A cell of a table; `attributes` is markup, with a space before.
[[nodiscard]] std::string cell(const Cell& text, std::string_view attributes = "");

// The number with so many decimals, or nothing.
[[nodiscard]] std::string decimals(const Cell& number, int count);

inline constexpr std::string_view kNumber = " class=n";

}  // namespace armsig::fleet
