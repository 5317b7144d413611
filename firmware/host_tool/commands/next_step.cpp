// SPDX-License-Identifier: MIT
#include "firmware/host_tool/commands/next_step.hpp"

#include <filesystem>
#include <system_error>

#include "firmware/formats/standard_output.hpp"
#include "firmware/host_tool/presentation/say.hpp"

namespace armsig::tool {

void say_next(const TypedCommand& command) { say("Next: {}\n", command.text()); }

TypedCommand& add_rows(TypedCommand& command, const RowSource& source) {
  return command.file_option("--measurements", source.measurements)
      .option("--columns", source.columns)
      .file_option("--sensor", source.sensor);
}

bool is_there_to_read(const std::string& path) {
  std::error_code ignored;
  return path != kStandardOutput && std::filesystem::is_regular_file(path, ignored);
}

}  // namespace armsig::tool
