// SPDX-License-Identifier: MIT
#include "firmware/formats/pi_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/pose.hpp"
#include "firmware/formats/text.hpp"

namespace armsig::tool {
namespace {

constexpr std::array<std::string_view, 5> kSpellings{"pi", "PI", "Pi", "\xCF\x80", "M_PI"};

struct PiWord {
  std::size_t at = std::string_view::npos;
  std::size_t length = 0;
};

PiWord pi_in(std::string_view text) {
  PiWord found;
  for (const std::string_view spelling : kSpellings) {
    const std::size_t at = text.find(spelling);
    if (at == std::string_view::npos) continue;
    // M_PI is found by its end, too: the longer word begins earlier.
    if (found.at == std::string_view::npos || at < found.at) found = {at, spelling.size()};
  }
  return found;
}

// What stands before pi: a sign, a number and perhaps a *; 1 where there is none.
std::optional<double> factor_before(std::string_view text) {
  text = trimmed(text);
  if (text.empty() || text == "+") return 1;
  if (text == "-") return -1;
  if (text.ends_with('*')) text.remove_suffix(1);
  return parse_number(trimmed(text));
}

// What stands behind it: * number, / number, or both.
std::optional<double> factor_behind(std::string_view text) {
  double factor = 1;
  text = trimmed(text);
  while (!text.empty()) {
    const char sign = text.front();
    if (sign != '*' && sign != '/') return std::nullopt;
    text = trimmed(text.substr(1));
    const std::size_t end = std::min(text.find_first_of("*/"), text.size());
    const auto number = parse_number(trimmed(text.substr(0, end)));
    if (!number || (sign == '/' && *number == 0)) return std::nullopt;
    factor = sign == '*' ? factor * *number : factor / *number;
    text = trimmed(text.substr(end));
  }
  return factor;
}

}  // namespace

bool names_pi(std::string_view text) { return pi_in(text).at != std::string_view::npos; }

std::optional<double> parse_pi(std::string_view text) {
  const PiWord word = pi_in(text);
  if (word.at == std::string_view::npos) return std::nullopt;
  const auto before = factor_before(text.substr(0, word.at));
  const auto behind = factor_behind(text.substr(word.at + word.length));
  if (!before || !behind) return std::nullopt;
  const double angle = *before * kPi * *behind;
  return std::isfinite(angle) ? std::optional(angle) : std::nullopt;
}

}  // namespace armsig::tool
