// SPDX-License-Identifier: MIT
// What each error of a controller means and what to do, for the live page.
#pragma once

#include <nlohmann/json.hpp>

namespace armsig::tool {

// {"FOLLOWING_ERROR": {"words": ..., "happened": ..., "todo": ...}, ...}: names as the console
// tells them, texts of the table in docs/messages.md.
[[nodiscard]] nlohmann::ordered_json web_advice();

}  // namespace armsig::tool
