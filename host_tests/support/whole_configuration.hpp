// SPDX-License-Identifier: MIT
// A whole configuration of the controller, its grid included, for tests that spoil one part.
#pragma once

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::test {

// Nothing in it is near its bounds.
[[nodiscard]] inline controller::Configuration whole_configuration() {
  controller::Configuration c = puma_controller();
  for (JointVector& q : c.grid.taught) q = c.sweeps.configuration;
  c.grid.taught[1][0] += 0.3;
  c.grid.taught[2][1] += 0.3;
  c.grid.grid.size_m = {0.1, 0.1, 0.1};
  c.grid.grid.count = {2, 2, 2};
  return c;
}

}  // namespace armsig::test
