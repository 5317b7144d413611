// SPDX-License-Identifier: MIT
// The indices of Table 3 by the whole controller, on drives as they are, with the sensors of both
// buses. One seed each here; ARMSIG_TABLE_3_SEEDS=5 runs seeds 1 to 5 (docs/bench.md).
#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

#include "host_tests/support/table_3_run.hpp"

namespace armsig::controller {
namespace {

using test::PumaCabinet;

std::uint64_t seeds() {
  const char* told = std::getenv("ARMSIG_TABLE_3_SEEDS");
  return told == nullptr ? 1 : std::strtoull(told, nullptr, 10);
}

void expect_table_3(const Configuration& configuration) {
  ASSERT_TRUE(check(configuration));
  const auto printed = tool::table3(1);
  for (std::uint64_t seed = 1; seed <= seeds(); ++seed) {
    PumaCabinet puma(seed, configuration, test::honest_puma_drive());
    const auto factors = test::table_3_run(puma, configuration);
    std::printf("seed %u: %.1f %.1f %.1f %.1f, %zu points in %.0f s\n", static_cast<unsigned>(seed),
                factors[0], factors[1], factors[2], factors[3],
                puma.cabinet->state().identification().log().size(),
                hal::seconds(puma.now().now.time_since_epoch()));
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_GE(factors[k], printed[k]) << "seed " << seed << ", index " << k + 1;
    }
  }
}

TEST(Table3, is_reached_with_the_eight_receivers_on_a_serial_line) {
  expect_table_3(test::puma_with_grid());
}

TEST(Table3, is_reached_with_the_six_receivers_on_can) {
  expect_table_3(test::with_six_receivers(test::puma_with_grid()));
}

}  // namespace
}  // namespace armsig::controller
