// SPDX-License-Identifier: MIT
// What a live page may ask for, in one table, and the lines for the controller that come of it.
#pragma once

#include <expected>
#include <string>
#include <string_view>
#include <vector>

namespace armsig::tool {

struct PageRequest {
  std::string viewer;
  std::string verb;
  std::string line;  // for the controller; empty: the server itself does it
};

// What `body` asks for, or why it is no request of the page. `revolute`: of each joint of the arm.
// The line is formatted from the table, from numbers, and from the name of a place, which has
// letters and digits: no other text of the browser gets into it.
[[nodiscard]] std::expected<PageRequest, std::string> page_request(
    std::string_view body, const std::vector<bool>& revolute);

// The verbs of the controller that the page has, each once.
[[nodiscard]] std::vector<std::string_view> page_verbs();

// Whether a viewer may have this name: 64 digits and small letters at most.
[[nodiscard]] bool is_viewer(std::string_view name);

}  // namespace armsig::tool
