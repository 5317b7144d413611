// SPDX-License-Identifier: MIT
// How `armsig connect CONSOLE --web` becomes the program armsig-web.
#pragma once

#include <cstddef>
#include <string_view>

#include "firmware/formats/problem.hpp"
#include "firmware/host_tool/console/web_page.hpp"

namespace armsig::tool {

// The words that armsig-web is started with: its name, then these.
inline constexpr std::size_t kConsoleWord = 1;
inline constexpr std::size_t kPortWord = 2;
inline constexpr std::size_t kTokenFileWord = 3;
inline constexpr std::size_t kFormWord = 4;  // of what it says where it does not start
inline constexpr std::size_t kWebWords = 5;
inline constexpr std::string_view kJsonForm = "json";
inline constexpr std::string_view kPlainForm = "plain";

// This process becomes armsig-web, which lies beside it or where it is installed; returns only what
// keeps it from that.
[[nodiscard]] Problem become_web_server(const WebPageOptions& options, bool json);

}  // namespace armsig::tool
