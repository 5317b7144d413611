// SPDX-License-Identifier: MIT
// Where bars, sockets, planes and anchors are to stand, on a sheet to print.
#pragma once

#include <string>
#include <string_view>

#include "firmware/host_tool/places/place_layout.hpp"
#include "firmware/host_tool/places/touch_search.hpp"

namespace armsig::tool {

// An SVG: from above and from the side in the arm's base frame, with what the tool reaches, and a
// line a place with its coordinates. `title` is any text.
[[nodiscard]] std::string place_drawing(const PlaceLayout& layout, const TouchSearch& search,
                                        std::string_view title);

}  // namespace armsig::tool
