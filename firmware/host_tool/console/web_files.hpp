// SPDX-License-Identifier: MIT
// The files of the live page, compiled in from console/web.
#pragma once

#include <array>
#include <string_view>

namespace armsig::tool {

struct WebFile {
  std::string_view name;
  std::string_view type;
  std::string_view content;
};

extern const std::array<WebFile, 9> kWebFiles;
// docs/messages.md: what a message means, and what to do.
extern const std::string_view kMessages;

}  // namespace armsig::tool
