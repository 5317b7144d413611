// SPDX-License-Identifier: MIT
// The Puma's cabinet half a second into a move.
#pragma once

#include <gtest/gtest.h>

#include "host_tests/support/puma_cabinet.hpp"

namespace armsig::test {

struct MovingPuma : PumaCabinet {
  MovingPuma() {
    EXPECT_TRUE(enable());
    EXPECT_EQ(ask("move q1_deg=90 q2_deg=-30"), "ok");
    run(0.5);
    EXPECT_EQ(mode(), controller::Mode::kServoing);
  }
};

}  // namespace armsig::test
