// SPDX-License-Identifier: MIT
// A line of text in which an instrument tells numbers by name: "point x_mm=812.4 y_mm=-31.8
// seq=17".
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <span>
#include <string_view>

namespace armsig::linux_hal {

// Of a coordinate or a length.
inline constexpr double kFarthest_mm = 100e3;

// What is wrong with a line: "z_mm" and "is not a number"; nothing of the line itself.
struct LineProblem {
  std::string_view key;
  std::string_view what;
};

[[nodiscard]] inline std::unexpected<LineProblem> line_problem(std::string_view key,
                                                               std::string_view what) {
  return std::unexpected(LineProblem{key, what});
}

struct LineForm {
  std::string_view word;     // with which it begins,
  std::string_view without;  // and what is said of a line that does not
  std::span<const std::string_view> keys;
};

// The values of the keys of `form` in `line`; empty where a key is not there. In any order, each at
// most once, separated by blanks. Precondition: a value for each key.
[[nodiscard]] std::expected<void, LineProblem> read_keyed_line(
    std::string_view line, const LineForm& form, std::span<std::optional<double>> values);

// `seq`, a whole number of 32 bits, where there is one.
[[nodiscard]] std::expected<std::optional<std::uint32_t>, LineProblem> sequence_in(
    const std::optional<double>& value);

}  // namespace armsig::linux_hal
