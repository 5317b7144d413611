// SPDX-License-Identifier: MIT
// What a controller's console says: words, and values by key (docs/console.md). A value with blanks
// stands in double quotes.
#pragma once

#include <optional>
#include <string_view>

namespace armsig::tool {

class ConsoleLine {
 public:
  // A word without a key has an empty one.
  struct Value {
    std::string_view key;
    std::string_view value;  // without its quotes
  };

  // Of `line`, which must outlive this.
  explicit ConsoleLine(std::string_view line) : left_(line) {}

  // The next word or value; nothing at the end of the line.
  [[nodiscard]] std::optional<Value> next();

 private:
  std::string_view left_;
};

// The value of `key` in `line`; nothing where the line does not have it.
[[nodiscard]] std::optional<std::string_view> value_in(std::string_view line, std::string_view key);

}  // namespace armsig::tool
