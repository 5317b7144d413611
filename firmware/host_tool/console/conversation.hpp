// SPDX-License-Identifier: MIT
// A person's side of a console: what a line that was typed asks for, what a word begun may become,
// and replies in words. Nothing here reads or writes.
#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "hal/console.hpp"

namespace armsig::tool {

// A verb as the controller's `help` tells it.
struct ConsoleVerb {
  std::string name;
  std::string does;
  std::string modes;   // in which it is allowed: "idle, holding"
  bool alone = false;  // with nothing else under way
};

class Conversation {
 public:
  static constexpr std::size_t kLongestLine = hal::kMaxConsoleLine;

  struct Step {
    std::string send;  // to the controller; empty: nothing
    std::string say;   // to the person; empty: nothing
    bool leaves = false;
  };

  // Replies to `help`, to `help VERB` for one of verbs(), and to `status`, as far as they came.
  // Where `help` did not, every line is sent as it was typed.
  void learn_verbs(std::string_view reply);
  void learn_verb(std::string_view reply);
  void learn_joints(std::string_view status);
  [[nodiscard]] const std::vector<ConsoleVerb>& verbs() const { return verbs_; }

  // What is to be done for a line that was typed; what is sent is counted as asked.
  [[nodiscard]] Step take(std::string_view typed, std::size_t width);

  // A line of the controller, for the person.
  [[nodiscard]] std::string hear(std::string_view line, std::size_t width);

  // What the last word of `before` may become, whole words; a word that ends with `=` wants a
  // value.
  [[nodiscard]] std::vector<std::string> completions(std::string_view before) const;

 private:
  [[nodiscard]] const ConsoleVerb* find(std::string_view name) const;
  [[nodiscard]] Step help(std::string_view subject, std::size_t width) const;
  [[nodiscard]] Step no_verb(std::string_view word) const;
  [[nodiscard]] std::vector<std::string> keys_of(std::string_view verb) const;
  [[nodiscard]] Step ask(std::string_view line, bool in_words);

  std::vector<ConsoleVerb> verbs_;
  std::vector<std::string> joints_;  // their keys in a status: q1_deg
  std::deque<bool> asked_;           // of each request without a reply: its reply in words
};

}  // namespace armsig::tool
