// SPDX-License-Identifier: MIT
// What the command says, to a person and to a program. Whatever it repeats of a file, an argument
// or a controller is escaped on the way (formats/characters.hpp): no terminal is given a command by
// it.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware/formats/wrapping.hpp"

namespace armsig::tool {

// Writes `text` with all but its line feeds escaped. Throws std::system_error where it can't.
void put(std::FILE* stream, std::string_view text);

template <typename... Values>
void say(std::FILE* stream, fmt::format_string<Values...> format, Values&&... values) {
  put(stream, fmt::format(format, std::forward<Values>(values)...));
}
template <typename... Values>
void say(fmt::format_string<Values...> format, Values&&... values) {
  put(stdout, fmt::format(format, std::forward<Values>(values)...));
}

// Says on standard error what is refused or doubtful, as one line, or wrapped on a terminal.
template <typename... Values>
void complain(fmt::format_string<Values...> format, Values&&... values) {
  put(stderr, for_standard_error(fmt::format(format, std::forward<Values>(values)...)));
}

// `json` as text; indent -1 for one line. In its strings what is not printable is escaped, bytes
// that are no UTF-8 are replaced by U+FFFD.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json, int indent);

}  // namespace armsig::tool
