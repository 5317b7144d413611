// SPDX-License-Identifier: MIT
// One measured row, as the filter takes it.
#include <memory>

#include <gtest/gtest.h>

#include "core/refinement/determination.hpp"
#include "core/refinement/row.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::refinement {
namespace {

using test::Random;

// An exact arm whose sensor is not: ranges alone tell how, and the axes stay where they are.
TEST(Row, of_a_range_tells_what_its_receiver_adds) {
  Random random(111);
  const test::Cell cell = test::puma_cell(random);
  const auto estimate = std::make_unique<Refined>();
  estimate->signature = test::signature_of(cell, test::cell_configuration());
  const Receivers receivers{Vector3(2, 0, 0), Vector3(0, 2, 1)};
  ParameterRequest request;
  request.receiver_offsets = true;
  const auto layout = make_layout(estimate->signature, {true}, request, receivers.size());
  ASSERT_TRUE(layout);
  estimate->layout = *layout;
  const std::array<double, 2> offsets{3e-3, -2e-3};
  const PoeChain chain(estimate->signature, estimate->readings);
  SquareRootFactor factor;
  set_wide_priors(estimate->layout, factor);
  for (int k = 0; k < 100; ++k) {
    Observation row;
    row.kind = ObservationKind::kRange;
    row.readings = random.configuration(cell.arm);
    row.receiver = static_cast<std::size_t>(k % 2);
    row.range_m =
        (cell.point(row.readings, 0) - receivers[row.receiver]).norm() + offsets[row.receiver];
    Linearised at;
    absorb_row(*estimate, receivers, chain, row, 1e6, factor, at);
  }
  const auto x = factor.solve();
  ASSERT_TRUE(x);
  for (std::size_t i = 0; i < estimate->layout.size(); ++i) {
    const bool offset = i >= estimate->layout.receiver_offsets;
    EXPECT_NEAR((*x)[i], offset ? offsets[i - estimate->layout.receiver_offsets] : 0, 1e-6) << i;
  }
}

}  // namespace
}  // namespace armsig::refinement
