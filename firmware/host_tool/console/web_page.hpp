// SPDX-License-Identifier: MIT
// armsig connect --web: the live page of a controller.
#pragma once

#include <string>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct WebPageOptions {
  std::string console;     // of the controller
  int port = 0;            // 0: a free one
  std::string token_file;  // keeps the address from one start to the next; may be empty
};

// Serves until the process ends; returns only what keeps it from that.
[[nodiscard]] Problem serve_web_page(const WebPageOptions& options);

}  // namespace armsig::tool
