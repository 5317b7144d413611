// SPDX-License-Identifier: MIT
// The files that one command was given: none is written over that is read, none is written twice.
#pragma once

#include <initializer_list>
#include <string_view>

#include "firmware/formats/problem.hpp"

namespace armsig::tool {

struct FileRole {
  std::string_view option;  // "--out"
  std::string_view path;    // empty where the option was not given
};

// Refuses a file of `written` that is one of `read`, or another of `written`: by whatever name,
// link or case. What is no regular file (a terminal, a pipe, /dev/null) may be both. Refuses,
// before the work is done, a file of `written` that check_writable() says can't be.
[[nodiscard]] Read<void> check_roles(std::initializer_list<FileRole> read,
                                     std::initializer_list<FileRole> written);

}  // namespace armsig::tool
