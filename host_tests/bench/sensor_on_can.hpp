// SPDX-License-Identifier: MIT
// The bench's sensor on the CAN bus in place of the serial line.
#pragma once

#include <string>

#include "host_tests/bench/daemon_process.hpp"

namespace armsig::bench {

// On CAN it has six receivers: three PDOs of two.
inline Changes sensor_on_can() {
  const std::string modbus =
      "  modbus:\n"
      "    device: /tmp/armsig-bench/sensor\n"
      "    poll_period_ms: 15\n"
      "    answer_timeout_ms: 2000\n";
  return {{modbus, "  can:\n    node: 32\n    reading_period_ms: 15\n"},
          {"    - {x_mm: 500,   y_mm: 500,   z_mm: 800}\n", ""},
          {"    - {x_mm: -500,  y_mm: 500,   z_mm: 800}\n", ""}};
}

}  // namespace armsig::bench
