// SPDX-License-Identifier: MIT
// A person at a terminal and a controller's console.
#pragma once

#include <chrono>

#include "firmware/host_tool/console/console_client.hpp"

namespace armsig::tool {

// Until the person leaves: true; or until the controller has gone: false. `longest`: the longest
// wait for what the controller says of its verbs, before the first line.
[[nodiscard]] bool talk_to_a_person(ConsoleClient& console, std::chrono::milliseconds longest);

}  // namespace armsig::tool
