// SPDX-License-Identifier: MIT
// A measured row of a long log, of which neighbours were merged for the fit.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace armsig::calibration {

// The row lies on the line through two rows of the fit, but for what it was measured beside it: its
// residual is (1 - share) times that of row `first` plus share times that of the next, plus
// `beside`. A row that was not merged is row `first` itself.
struct RowPart {
  std::uint32_t first = 0;                           // FitRow::index
  float share = 0;                                   // 0 where one row of the fit stands for it
  Eigen::Vector3f beside = Eigen::Vector3f::Zero();  // [m]
};

// Its residual, of those of the two rows of the fit.
[[nodiscard]] inline Eigen::Vector3d residual_of(const RowPart& part, const Eigen::Vector3d& first,
                                                 const Eigen::Vector3d& second) {
  const auto share = static_cast<double>(part.share);
  return (1 - share) * first + share * second + part.beside.cast<double>();
}

}  // namespace armsig::calibration
