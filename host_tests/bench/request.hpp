// SPDX-License-Identifier: MIT
// A request to the emulated arm: `verb key=value ...`, as on the controller's console.
#pragma once

#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace armsig::bench {

class Request {
 public:
  // Words apart by blanks. A word without '=' after the first, or a key twice, is remembered as the
  // first thing wrong.
  explicit Request(std::string_view line);

  [[nodiscard]] const std::string& verb() const { return verb_; }

  // The value of `key`; absent keys and numbers that are none are remembered as wrong by the ones
  // that must have a value.
  [[nodiscard]] std::optional<std::string> find(std::string_view key);
  [[nodiscard]] std::string text(std::string_view key);
  [[nodiscard]] double number(std::string_view key);
  [[nodiscard]] std::optional<double> find_number(std::string_view key);
  // Decimal, or hexadecimal after 0x.
  [[nodiscard]] int integer(std::string_view key, int lowest, int highest);

  // What is wrong with the request so far, a key that nobody asked for included; empty: nothing.
  [[nodiscard]] std::string wrong() const;

 private:
  void complain(std::string what);

  std::string verb_;
  std::map<std::string, std::string, std::less<>> values_;
  std::map<std::string, bool, std::less<>> asked_;
  std::string wrong_;
};

}  // namespace armsig::bench
