// SPDX-License-Identifier: MIT
// `--out -`: the file that a command writes goes to standard output, its words elsewhere.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace armsig::tool {

// Whether one of the words of a command line asks for it.
[[nodiscard]] bool asks_for_standard_output(std::span<const std::string> words);

// From now on what is said on standard output is said on standard error.
void leave_standard_output_to_the_file();

// What a person is told of `file`, the argument of --out.
[[nodiscard]] std::string file_in_words(const std::string& file);

// Where what was written is: `in FILE`, or on standard output.
[[nodiscard]] std::string place_in_words(const std::string& file);

}  // namespace armsig::tool
