// SPDX-License-Identifier: MIT
#include "host_tests/bench/request.hpp"

#include <cmath>
#include <sstream>

namespace armsig::bench {

Request::Request(std::string_view line) {
  std::istringstream words{std::string(line)};
  words >> verb_;
  for (std::string word; words >> word;) {
    const std::size_t equals = word.find('=');
    if (equals == std::string::npos || equals == 0) {
      complain(word + " is no key=value");
    } else if (!values_.emplace(word.substr(0, equals), word.substr(equals + 1)).second) {
      complain(word.substr(0, equals) + " is given twice");
    }
  }
}

void Request::complain(std::string what) {
  if (wrong_.empty()) wrong_ = std::move(what);
}

std::optional<std::string> Request::find(std::string_view key) {
  asked_[std::string(key)] = true;
  const auto found = values_.find(key);
  if (found == values_.end()) return std::nullopt;
  return found->second;
}

std::string Request::text(std::string_view key) {
  auto value = find(key);
  if (!value) complain("needs " + std::string(key) + "=...");
  return value.value_or("");
}

std::optional<double> Request::find_number(std::string_view key) {
  const auto value = find(key);
  if (!value) return std::nullopt;
  double number = 0;
  const char* end = value->data() + value->size();
  const auto [stop, status] = std::from_chars(value->data(), end, number);
  if (status != std::errc{} || stop != end || !std::isfinite(number)) {
    complain(std::string(key) + " is no number: " + *value);
    return std::nullopt;
  }
  return number;
}

double Request::number(std::string_view key) {
  if (!find(key)) complain("needs " + std::string(key) + "=...");
  return find_number(key).value_or(0);
}

int Request::integer(std::string_view key, int lowest, int highest) {
  const std::string value = text(key);
  const bool hexadecimal = value.starts_with("0x");
  const char* begin = value.data() + (hexadecimal ? 2 : 0);
  const char* end = value.data() + value.size();
  int number = lowest;
  const auto [stop, status] = std::from_chars(begin, end, number, hexadecimal ? 16 : 10);
  if (status != std::errc{} || stop != end || number < lowest || number > highest) {
    complain(std::string(key) + " must be " + std::to_string(lowest) + " to " +
             std::to_string(highest));
    return lowest;
  }
  return number;
}

std::string Request::wrong() const {
  if (!wrong_.empty()) return wrong_;
  for (const auto& [key, value] : values_) {
    if (!asked_.contains(key)) return "unknown key " + key;
  }
  return {};
}

}  // namespace armsig::bench
