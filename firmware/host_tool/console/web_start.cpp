// SPDX-License-Identifier: MIT
#include "firmware/host_tool/console/web_start.hpp"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

namespace armsig::tool {

Problem become_web_server(const WebPageOptions& options, bool json) {
  constexpr const char* kName = "armsig-web";
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::array places{here / kName, (here / ARMSIG_WEB_FOLDER / kName).lexically_normal()};
  const std::string port = std::to_string(options.port);
  const std::string form(json ? kJsonForm : kPlainForm);
  std::array<const char*, kWebWords + 1> words{};
  words[0] = kName;
  words[kConsoleWord] = options.console.c_str();
  words[kPortWord] = port.c_str();
  words[kTokenFileWord] = options.token_file.c_str();
  words[kFormWord] = form.c_str();
  int why = ENOENT;
  for (const auto& place : places) {
    // execv promises to change none of its words.
    ::execv(place.c_str(), const_cast<char* const*>(words.data()));
    why = errno;
    if (why != ENOENT) return {place.string(), 0, 0, std::strerror(why), "a program to run"};
  }
  return {places.back().string(), 0, 0, std::strerror(why),
          "the program of the live page, which is installed with armsig"};
}

}  // namespace armsig::tool
