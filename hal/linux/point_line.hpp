// SPDX-License-Identifier: MIT
// A line in which an instrument tells a point:
//
//   point x_mm=812.403 y_mm=-31.77 z_mm=455.019 [sigma_mm=0.02] [seq=17]
//
// Instead of sigma_mm, which holds along each axis, the whole covariance: cxx_mm2= cxy_mm2=
// cxz_mm2= cyy_mm2= cyz_mm2= czz_mm2=.
#pragma once

#include <cstdint>
#include <expected>
#include <optional>
#include <string_view>

#include "core/base/pose.hpp"
#include "hal/linux/keyed_line.hpp"
#include "hal/point_instrument.hpp"

namespace armsig::linux_hal {

inline constexpr double kLeastPointSigma_mm = 1e-3;
inline constexpr double kLargestPointSigma_mm = 50;

struct PointLine {
  using Reading = hal::PointReading;

  Vector3 p_S = Vector3::Zero();
  std::optional<Matrix3> covariance_m2;
  std::optional<std::uint32_t> sequence;

  [[nodiscard]] static std::expected<PointLine, LineProblem> parse(std::string_view line);
  [[nodiscard]] Reading reading(hal::Instant at, std::uint32_t number) const {
    return {.p_S = p_S, .covariance_m2 = covariance_m2, .at = at, .sequence = number};
  }
};

}  // namespace armsig::linux_hal
