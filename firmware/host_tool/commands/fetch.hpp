// SPDX-License-Identifier: MIT
// armsig connect CONSOLE fetch FILE: what the controller has, as a file.
#pragma once

#include <chrono>
#include <string>

#include "firmware/host_tool/commands/command.hpp"
#include "firmware/host_tool/console/console_client.hpp"

namespace armsig::tool {

struct FetchOptions : CommonOptions {
  std::string console;  // its path
  std::string file;
  std::string what;  // signature, candidate, drawing, log; empty: log for FILE.csv, else signature
  std::string name = "arm of a controller";
  std::string serial;
  std::string by;  // of send: who sends it; empty: not told
  std::chrono::milliseconds longest{};
};

// Writes the file; its exit status.
[[nodiscard]] int fetch(ConsoleClient& console, const FetchOptions& options);

}  // namespace armsig::tool
