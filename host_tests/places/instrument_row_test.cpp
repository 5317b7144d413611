// SPDX-License-Identifier: MIT
// Every instrument's derivatives, by perturbation.
#include "firmware/host_tool/places/instrument_row.hpp"

#include <gtest/gtest.h>

namespace armsig::tool {
namespace {

constexpr double kStep = 1e-6;
constexpr double kTolerance = 1e-8;
constexpr double kLength_m = 0.61;
const Vector3 kTool(0.4, -0.3, 0.5);

TouchedPlace a_place(InstrumentKind kind) {
  TouchedPlace place{
      .name = "P", .kind = kind, .point_B = Vector3(0.2, 0.1, -0.3), .distance_m = 0.2};
  if (kind == InstrumentKind::kPlane) place.point_B.normalize();
  return place;
}

class AnyInstrument : public testing::TestWithParam<InstrumentKind> {
 protected:
  TouchedPlace place_ = a_place(GetParam());
  WireScale scale_{.gain = 0.02, .zero_m = 0.03};

  [[nodiscard]] InstrumentRow row() const {
    return instrument_row(place_, scale_, kTool, kLength_m);
  }
  // The change of the residual over that of an unknown, which `at` gives the residual at.
  template <typename At>
  static Vector3 slope(At at) {
    return (at(kStep).residual - at(-kStep).residual) / (2 * kStep);
  }
};

TEST_P(AnyInstrument, has_the_derivatives_by_the_tool_that_perturbation_gives) {
  for (Eigen::Index c = 0; c < 3; ++c) {
    const Vector3 found = slope([&](double by) {
      return instrument_row(place_, scale_, kTool + by * Vector3::Unit(c), kLength_m);
    });
    EXPECT_LT((found - row().by_point.col(c)).norm(), kTolerance);
  }
}

TEST_P(AnyInstrument, has_the_derivatives_by_its_place_that_perturbation_gives) {
  for (Eigen::Index c = 0; c < 3; ++c) {
    const Vector3 found = slope([&](double by) {
      TouchedPlace moved = place_;
      move(moved, by * Vector3::Unit(c));
      return instrument_row(moved, scale_, kTool, kLength_m);
    });
    EXPECT_LT((found - row().by_place.col(c)).norm(), kTolerance);
  }
}

TEST_P(AnyInstrument, has_the_derivatives_by_gain_and_zero_that_perturbation_gives) {
  const Vector3 by_gain = slope([&](double by) {
    return instrument_row(place_, {scale_.gain + by, scale_.zero_m}, kTool, kLength_m);
  });
  const Vector3 by_zero = slope([&](double by) {
    return instrument_row(place_, {scale_.gain, scale_.zero_m + by}, kTool, kLength_m);
  });
  EXPECT_LT((by_gain - row().by_scale.col(0)).norm(), kTolerance);
  EXPECT_LT((by_zero - row().by_scale.col(1)).norm(), kTolerance);
}

TEST_P(AnyInstrument, measures_three_numbers_in_a_socket_and_one_elsewhere) {
  EXPECT_EQ(row().scalars, GetParam() == InstrumentKind::kSocket ? 3 : 1);
}

INSTANTIATE_TEST_SUITE_P(Instruments, AnyInstrument,
                         testing::Values(InstrumentKind::kSocket, InstrumentKind::kPlane,
                                         InstrumentKind::kWire));

TEST(InstrumentRow, of_a_socket_is_zero_at_its_centre) {
  const TouchedPlace socket{.name = "A1", .point_B = kTool};
  EXPECT_EQ(instrument_row(socket, {}, kTool, 0).residual, Vector3::Zero());
}

TEST(InstrumentRow, of_a_plane_is_the_distance_from_it) {
  const TouchedPlace table{.name = "table",
                           .kind = InstrumentKind::kPlane,
                           .point_B = Vector3::UnitZ(),
                           .distance_m = 0.48};
  EXPECT_NEAR(instrument_row(table, {}, kTool, 0).residual[0], 0.02, 1e-15);
}

TEST(InstrumentRow, of_a_wire_adds_its_zero_to_its_length_and_the_gain_on_it) {
  const TouchedPlace wire{
      .name = "W", .kind = InstrumentKind::kWire, .point_B = kTool - Vector3(0, 0, 1)};
  EXPECT_NEAR(instrument_row(wire, {0.1, 0.01}, kTool, 0.9).residual[0], 0, 1e-15);
}

TEST(LengthRow, has_the_derivative_that_perturbation_gives) {
  const TouchedPlace first = a_place(InstrumentKind::kSocket);
  TouchedPlace second = first;
  second.point_B += Vector3(0.1, 0.2, 0.2);
  EXPECT_NEAR(length_row(first, second, 0.29).residual_m, 0.01, 1e-15);
  for (Eigen::Index c = 0; c < 3; ++c) {
    const auto at = [&](double by) {
      TouchedPlace moved = second;
      move(moved, by * Vector3::Unit(c));
      return length_row(first, moved, 0.29).residual_m;
    };
    EXPECT_NEAR((at(kStep) - at(-kStep)) / (2 * kStep),
                length_row(first, second, 0.29).by_second[c], kTolerance);
  }
}

}  // namespace
}  // namespace armsig::tool
