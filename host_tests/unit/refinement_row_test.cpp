// SPDX-License-Identifier: MIT
// One measured row, as the filter takes it.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "core/calibration/row.hpp"
#include "firmware/analysis/starts/determination.hpp"
#include "host_tests/support/simulated_arm.hpp"

namespace armsig::calibration {
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
    absorb_row(*estimate, receivers, chain, row, 1e6, factor);
  }
  const auto x = factor.solve();
  ASSERT_TRUE(x);
  for (std::size_t i = 0; i < estimate->layout.size(); ++i) {
    const bool offset = i >= estimate->layout.receiver_offsets;
    EXPECT_NEAR((*x)[i], offset ? offsets[i - estimate->layout.receiver_offsets] : 0, 1e-6) << i;
  }
}

// Everything else held fast.
TEST(Row, of_either_kind_tells_by_how_much_lengths_are_wrong) {
  constexpr double kScale = 2e-3;
  Random random(112);
  const test::Cell cell = test::puma_cell(random);
  const auto estimate = std::make_unique<Refined>();
  estimate->signature = test::signature_of(cell, test::cell_configuration());
  ParameterRequest request;
  request.scale = true;
  const auto layout = make_layout(estimate->signature, {true}, request, 1);
  ASSERT_TRUE(layout);
  estimate->layout = *layout;
  const PoeChain chain(estimate->signature, estimate->readings);
  const Receivers receivers{Vector3(2, 0, 0)};
  for (const ObservationKind kind : {ObservationKind::kPosition, ObservationKind::kRange}) {
    SquareRootFactor factor;
    factor.reset(layout->size());
    for (std::size_t i = 0; i < layout->size(); ++i) {
      factor.set_entry(i, i, i == layout->scale ? 1 : 1e9);
    }
    Observation row = test::observe(cell, random.configuration(cell.arm), 0, 0, random);
    row.kind = kind;
    row.range_m = (1 + kScale) * (row.p_S - receivers[0]).norm();
    row.p_S *= 1 + kScale;
    absorb_row(*estimate, receivers, chain, row, 1e5, factor);
    const auto x = factor.solve();
    ASSERT_TRUE(x);
    EXPECT_NEAR((*x)[layout->scale], kScale, 1e-5);
  }
}

TEST(Row, of_a_range_to_a_receiver_that_the_target_touches_has_no_direction) {
  Refined estimate;
  estimate.receiver_offsets_m[0] = 1e-3;
  const Receivers receivers{Vector3(1, 2, 3)};
  Observation row;
  row.kind = ObservationKind::kRange;
  const PredictedRange predicted = predict_range(estimate, receivers, row, receivers[0]);
  EXPECT_EQ(predicted.value, 1e-3);
  EXPECT_TRUE(predicted.gradient.isZero(0));
}

TEST(Row, is_judged_by_what_its_kind_measured) {
  Refined estimate;
  const Receivers receivers{Vector3(0, 0, 0)};
  Observation row;
  row.p_S = Vector3(std::nan(""), 0, 0);
  row.range_m = 5.5;
  EXPECT_FALSE(is_finite(row));
  EXPECT_EQ(thresholds(row).gate, numerics::kThresholds3.gate);
  row.kind = ObservationKind::kRange;
  EXPECT_TRUE(is_finite(row));
  EXPECT_EQ(thresholds(row).gate, numerics::kThresholds1.gate);
  EXPECT_DOUBLE_EQ(residual_length(estimate, receivers, row, Vector3(3, 4, 0)), 0.5);
  row.range_m = std::nan("");
  EXPECT_FALSE(is_finite(row));
}

}  // namespace
}  // namespace armsig::calibration
