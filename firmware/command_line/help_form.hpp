// SPDX-License-Identifier: MIT
// How --help shows an option: what it takes in words of a person, and what else holds for it behind
// its description.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace armsig::tool {

class HelpForm : public CLI::Formatter {
 public:
  HelpForm();

  // What the option takes: FILE, NUMBER, TEXT, or its words with bars between them.
  [[nodiscard]] std::string make_option_opts(const CLI::Option* option) const override;
  // Its description; then whether it is required, its range, default, and the options that it needs
  // or excludes.
  [[nodiscard]] std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace armsig::tool
