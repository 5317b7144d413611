// SPDX-License-Identifier: MIT
// Text in lines that fit where it is read.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace armsig::tool {

using Lines = std::vector<std::string>;

// Columns that standard output has: those of the terminal, 80 where it is none.
[[nodiscard]] std::size_t output_width();

// Characters, not bytes: the texts are UTF-8.
[[nodiscard]] std::size_t width_of(std::string_view text);

// `text` in lines of at most `width` characters, broken at spaces; a longer word has its own line.
[[nodiscard]] Lines wrapped(std::string_view text, std::size_t width);

// `text` as a paragraph: every line begins with `indent` spaces and ends with a newline.
[[nodiscard]] std::string paragraph(std::string_view text, std::size_t indent = 2,
                                    std::size_t width = output_width());

// `text`, what a program refuses or warns of, for standard error: where that is a terminal, lines
// that fit it, the second and later ones indented; elsewhere one line, for what reads it.
[[nodiscard]] std::string for_standard_error(std::string_view text);

}  // namespace armsig::tool
