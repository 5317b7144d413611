// SPDX-License-Identifier: MIT
// A console whose operator is a test.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "hal/console.hpp"

namespace armsig::test {

class LineConsole final : public hal::Console {
 public:
  std::deque<std::string> requests;
  std::vector<std::string> replies;
  std::vector<std::string> told;  // unsolicited
  std::optional<Error> next_error;

 private:
  std::optional<hal::ConsoleLine> do_read_line() override {
    hal::ConsoleLine line{.client = 1, .characters = {}, .error = {}};
    if (next_error) {
      line.error = next_error;
      next_error.reset();
      return line;
    }
    if (requests.empty()) return std::nullopt;
    for (const char c : requests.front()) line.characters.push_back(c);
    requests.pop_front();
    return line;
  }
  Result<void> do_write_line(hal::ConsoleClient /*client*/, std::string_view text) override {
    replies.emplace_back(text);
    return {};
  }
  void do_broadcast(std::string_view text) override { told.emplace_back(text); }
};

}  // namespace armsig::test
