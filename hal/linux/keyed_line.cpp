// SPDX-License-Identifier: MIT
#include "hal/linux/keyed_line.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace armsig::linux_hal {
namespace {

bool is_printed(char c) { return c >= 0x20 && c < 0x7F; }

// The next word of `rest`, which it is taken from; empty: there is none.
std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = std::min(rest.find_first_not_of(' '), rest.size());
  const std::size_t end = std::min(rest.find(' ', begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

std::expected<void, LineProblem> take_word(std::string_view word,
                                           std::span<const std::string_view> keys,
                                           std::span<std::optional<double>> values) {
  const std::size_t equals = word.find('=');
  const auto known = std::ranges::find(keys, word.substr(0, equals));
  if (equals == std::string_view::npos || known == keys.end()) {
    return line_problem("a key", "is unknown");
  }
  auto& value = values[static_cast<std::size_t>(known - keys.begin())];
  if (value) return line_problem(*known, "is there twice");
  const std::string_view text = word.substr(equals + 1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
    return line_problem(*known, "is not a number");
  }
  value = number;
  return {};
}

}  // namespace

std::expected<void, LineProblem> read_keyed_line(std::string_view line, const LineForm& form,
                                                 std::span<std::optional<double>> values) {
  if (!std::ranges::all_of(line, is_printed)) return line_problem("the line", "is not text");
  if (next_word(line) != form.word) return line_problem("the line", form.without);
  for (std::string_view next = next_word(line); !next.empty(); next = next_word(line)) {
    if (auto taken = take_word(next, form.keys, values); !taken) return taken;
  }
  return {};
}

std::expected<std::optional<std::uint32_t>, LineProblem> sequence_in(
    const std::optional<double>& value) {
  if (!value) return std::nullopt;
  if (!(*value >= 0 && *value <= UINT32_MAX && *value == std::floor(*value))) {
    return line_problem("seq", "is not a whole number of 32 bits");
  }
  return static_cast<std::uint32_t>(*value);
}

}  // namespace armsig::linux_hal
