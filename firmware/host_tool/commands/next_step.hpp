// SPDX-License-Identifier: MIT
// The command that a person is told to type next.
#pragma once

#include <string>

#include "firmware/command_line/typed_command.hpp"
#include "firmware/host_tool/reading/read_rows.hpp"

namespace armsig::tool {

// "Next: armsig ..." on standard output, on one line.
void say_next(const TypedCommand& command);

// --measurements, --columns and --sensor as in `source`.
TypedCommand& add_rows(TypedCommand& command, const RowSource& source);

// Can what is typed later read what was read under that name? A pipe is gone by then.
[[nodiscard]] bool is_there_to_read(const std::string& path);

}  // namespace armsig::tool
