// SPDX-License-Identifier: MIT
#include "firmware/formats/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "firmware/formats/characters.hpp"

namespace armsig::tool {
namespace {

// How many characters are replaced, added, left out, or exchanged with the next one: the optimal
// string alignment distance (Damerau 1964; Levenshtein 1966), three rows at a time.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({replaced, row[j - 1] + 1, last[j] + 1});
      const bool exchanged = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (exchanged) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row.back();
}

std::string list(std::span<const std::string> words, std::string_view before_last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? before_last : ", ";
    text += words[i];
  }
  return text;
}

// std::from_chars takes no plus sign; one is tolerated here.
std::string_view without_plus(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  return text;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::size_t end = 0;  // of the last character that fits
  while (end < text.size()) {
    const std::size_t length = std::max<std::size_t>(first_character(text.substr(end)).length, 1);
    if (end + length > kLongest) break;
    end += length;
  }
  std::string quoted(1, '"');
  quoted += shown(text.substr(0, end));
  quoted += end < text.size() ? "...\"" : "\"";
  return quoted;
}

std::string any_of(std::span<const std::string> words) { return list(words, " or "); }

std::string all_of(std::span<const std::string> words) { return list(words, " and "); }

std::string nearest(std::string_view word, std::span<const std::string> candidates) {
  constexpr std::size_t kLongest = 40;  // nothing that long is one of our names
  if (word.size() > kLongest) return {};
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(word.size() / 3, 1) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::optional<double> parse_number(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
    return std::nullopt;
  }
  return value;
}

std::string why_not_a_number(std::string_view text) {
  if (text.empty()) return "nothing where a number should be";
  // YAML spells them .nan and .inf.
  std::string_view word = without_plus(text);
  if (word.starts_with('-')) word.remove_prefix(1);
  if (word.starts_with('.')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end == word.data() + word.size()) {
    if (error == std::errc::result_out_of_range) return in_quotes(text) + " is out of range";
    if (!std::isfinite(value)) return in_quotes(text) + " is not a finite number";
  }
  return in_quotes(text) + " is not a number";
}

std::optional<int> parse_integer(std::string_view text) {
  text = without_plus(text);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string number_text(double value) { return fmt::format("{}", value); }

std::optional<std::size_t> first_bad_byte(std::string_view text) {
  for (std::size_t at = 0; at < text.size(); ++at) {
    const auto bad = first_unprintable(text.substr(at));
    if (!bad) return std::nullopt;
    at += *bad;
    const char c = text[at];
    if (c != '\t' && c != '\n' && c != '\r') return at;
  }
  return std::nullopt;
}

}  // namespace armsig::tool
