// SPDX-License-Identifier: MIT
#include "firmware/host_tool/presentation/say.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "firmware/formats/characters.hpp"
#include "firmware/formats/standard_output.hpp"
#include "firmware/formats/terminal_line.hpp"
#include "firmware/host_tool/presentation/standard_output.hpp"

namespace armsig::tool {
namespace {

// Set once, before a command runs.
bool output_is_the_file = false;

// \uNNNN, or two of them for what is above U+FFFF.
std::string json_escape(std::uint32_t code) {
  if (code < 0x10000) return fmt::format("\\u{:04x}", code);
  const std::uint32_t above = code - 0x10000;
  return fmt::format("\\u{:04x}\\u{:04x}", 0xD800U + (above >> 10U), 0xDC00U + (above & 0x3FFU));
}

}  // namespace

bool asks_for_standard_output(std::span<const std::string> words) {
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--out=-" || words[k] == "-o-") return true;
    if ((words[k] == "--out" || words[k] == "-o") && k + 1 < words.size() && words[k + 1] == "-") {
      return true;
    }
  }
  return false;
}

void leave_standard_output_to_the_file() { output_is_the_file = true; }

std::string file_in_words(const std::string& file) {
  return file == kStandardOutput ? "standard output" : file;
}

std::string place_in_words(const std::string& file) {
  return (file == kStandardOutput ? "on " : "in ") + file_in_words(file);
}

void put(std::FILE* stream, std::string_view text) {
  if (output_is_the_file && stream == stdout) stream = stderr;
  TerminalLine::of_this_process().clear();
  const std::string safe = shown_lines(text);
  if (std::fwrite(safe.data(), 1, safe.size(), stream) < safe.size()) {
    throw std::system_error(errno, std::generic_category(), "the output can't be written");
  }
}

std::string json_text(const nlohmann::ordered_json& json, int indent) {
  const std::string dumped =
      json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string text;
  text.reserve(dumped.size());
  // Control characters below U+0020 are escaped already: what is left of them is layout.
  for (std::string_view rest = dumped; !rest.empty();) {
    const auto [bytes, code] = first_character(rest);
    const std::size_t length = std::max<std::size_t>(bytes, 1);
    if (is_printable(code) || rest[0] == '\n') {
      text += rest.substr(0, length);
    } else {
      text += json_escape(code);
    }
    rest.remove_prefix(length);
  }
  return text;
}

}  // namespace armsig::tool
