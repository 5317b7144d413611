// SPDX-License-Identifier: MIT
// `--out -`: the file that a command writes goes to standard output, its words elsewhere.
#pragma once

#include <span>
#include <string>

namespace armsig::tool {

// Whether one of the words of a command line asks for it.
[[nodiscard]] bool asks_for_standard_output(std::span<const std::string> words);

// From now on what is said on standard output is said on standard error.
void leave_standard_output_to_the_file();

}  // namespace armsig::tool
