// SPDX-License-Identifier: MIT
// A command that a person is told to type. Every command that a program prints is made
// here: it is quoted for the shell, and host_tests/docs/printed_commands runs it as printed.
#pragma once

#include <string>
#include <string_view>

namespace armsig::tool {

// `word` as the shell (bash, zsh, ksh) reads it back, byte for byte, on one line. A word of
// letters, digits and _@%+=:,./- is left as it is; what is not printable becomes $'\NNN'.
[[nodiscard]] std::string shell_quoted(std::string_view word);

class TypedCommand {
 public:
  // `command` of armsig: "identify".
  explicit TypedCommand(std::string_view command);
  // Another program: "check_urdf".
  [[nodiscard]] static TypedCommand of_program(std::string_view program);

  // A word that is no file.
  TypedCommand& word(std::string_view word);
  // A file; of a name with a leading dash ./NAME, which no command takes for an option.
  TypedCommand& file(std::string_view path);
  // `name` with its value; nothing where the value is empty.
  TypedCommand& option(std::string_view name, std::string_view value);
  // `name` with a file; nothing where the path is empty.
  TypedCommand& file_option(std::string_view name, std::string_view path);

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  TypedCommand() = default;

  std::string text_;
};

}  // namespace armsig::tool
