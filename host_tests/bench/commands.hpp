// SPDX-License-Identifier: MIT
// What a test can ask of the emulated arm while it runs (docs/bench.md lists the requests).
#pragma once

#include <string>
#include <string_view>

#include "host_tests/bench/plant.hpp"

namespace armsig::bench {

// Carries out `line` and returns the reply, "ok ..." or "error CODE text".
[[nodiscard]] std::string answer(Plant& plant, std::string_view line);

}  // namespace armsig::bench
