// SPDX-License-Identifier: MIT
// A line in which an instrument tells the lengths of up to eight wires, numbered as the anchors:
//
//   lengths l1_mm=812.403 l2_mm=1031.77 l3_mm=955.019 [seq=17]
//
// One that is not read is left out.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "hal/length_instrument.hpp"
#include "hal/linux/keyed_line.hpp"

namespace armsig::linux_hal {

struct LengthLine {
  using Reading = hal::LengthReading;

  decltype(Reading::lengths_m) lengths_m;
  std::optional<std::uint32_t> sequence;

  [[nodiscard]] static std::expected<LengthLine, LineProblem> parse(std::string_view line);
  [[nodiscard]] Reading reading(hal::Instant at, std::uint32_t number) const {
    return {.lengths_m = lengths_m, .at = at, .sequence = number};
  }
};

}  // namespace armsig::linux_hal
