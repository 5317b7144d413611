// SPDX-License-Identifier: MIT
#include "hal/linux/length_line.hpp"

#include <array>
#include <cstddef>

namespace armsig::linux_hal {
namespace {

constexpr std::array<std::string_view, hal::kMaxLengths + 1> kLengthKeys{
    "l1_mm", "l2_mm", "l3_mm", "l4_mm", "l5_mm", "l6_mm", "l7_mm", "l8_mm", "seq"};
constexpr LineForm kLengthForm{"lengths", "does not begin with lengths", kLengthKeys};

}  // namespace

std::expected<LengthLine, LineProblem> LengthLine::parse(std::string_view text) {
  std::array<std::optional<double>, kLengthKeys.size()> values;
  if (auto read = read_keyed_line(text, kLengthForm, values); !read) {
    return std::unexpected(read.error());
  }
  LengthLine line;
  for (std::size_t i = 0; i < hal::kMaxLengths; ++i) {
    if (!values[i]) continue;
    if (!(*values[i] > 0 && *values[i] <= kFarthest_mm)) {
      return line_problem(kLengthKeys[i], "is not between 0 and 100 m");
    }
    while (line.lengths_m.size() < i) line.lengths_m.push_back(std::nullopt);
    line.lengths_m.push_back(1e-3 * *values[i]);
  }
  if (line.lengths_m.empty()) return line_problem("the line", "has no length");
  const auto sequence = sequence_in(values[hal::kMaxLengths]);
  if (!sequence) return std::unexpected(sequence.error());
  line.sequence = *sequence;
  return line;
}

}  // namespace armsig::linux_hal
