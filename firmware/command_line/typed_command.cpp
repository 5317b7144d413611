// SPDX-License-Identifier: MIT
#include "firmware/command_line/typed_command.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_@%+=:,./-").contains(c);
}

// 'it'\''s'
std::string in_single_quotes(std::string_view word) {
  std::string text = "'";
  for (const char c : word) {
    if (c == '\'') {
      text += R"('\'')";
    } else {
      text += c;
    }
  }
  return text + "'";
}

// $'a\012b'. Octal digits are always three, so that a digit after them is no part of them.
std::string in_escapes(std::string_view word) {
  std::string text = "$'";
  while (!word.empty()) {
    const Character character = first_character(word);
    const std::size_t length = std::max<std::size_t>(character.length, 1);
    if (character.length == 0 || !is_printable(character.code)) {
      for (const char byte : word.substr(0, length)) {
        text += fmt::format("\\{:03o}", static_cast<unsigned char>(byte));
      }
    } else {
      if (word[0] == '\'' || word[0] == '\\') text += '\\';
      text += word.substr(0, length);
    }
    word.remove_prefix(length);
  }
  return text + "'";
}

std::string file_word(std::string_view path) {
  return shell_quoted(path.starts_with('-') ? "./" + std::string(path) : std::string(path));
}

}  // namespace

std::string shell_quoted(std::string_view word) {
  if (!word.empty() && std::ranges::all_of(word, is_plain)) return std::string(word);
  return first_unprintable(word) ? in_escapes(word) : in_single_quotes(word);
}

TypedCommand::TypedCommand(std::string_view command) : text_(fmt::format("armsig {}", command)) {}

TypedCommand TypedCommand::of_program(std::string_view program) {
  TypedCommand command;
  command.text_ = program;
  return command;
}

TypedCommand& TypedCommand::word(std::string_view word) {
  text_ += " " + shell_quoted(word);
  return *this;
}

TypedCommand& TypedCommand::file(std::string_view path) {
  text_ += " " + file_word(path);
  return *this;
}

TypedCommand& TypedCommand::option(std::string_view name, std::string_view value) {
  if (value.empty()) return *this;
  text_ += fmt::format(" {}{}{}", name, value.starts_with('-') ? '=' : ' ', shell_quoted(value));
  return *this;
}

TypedCommand& TypedCommand::file_option(std::string_view name, std::string_view path) {
  if (path.empty()) return *this;
  text_ += fmt::format(" {} {}", name, file_word(path));
  return *this;
}

}  // namespace armsig::tool
