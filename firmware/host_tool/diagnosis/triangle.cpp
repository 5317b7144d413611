// SPDX-License-Identifier: MIT
#include "firmware/host_tool/diagnosis/triangle.hpp"

#include <algorithm>

#include <Eigen/Dense>

namespace armsig::tool {

namespace {

constexpr Eigen::Index kPanel = 32;

}  // namespace

Eigen::MatrixXd inverse_of_lower(const Eigen::MatrixXd& L) {
  const Eigen::Index size = L.rows();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Identity(size, size);
  for (Eigen::Index first = 0; first < size; first += kPanel) {
    const Eigen::Index below = size - first;
    auto panel = inverse.block(first, first, below, std::min(kPanel, below));
    L.bottomRightCorner(below, below).triangularView<Eigen::Lower>().solveInPlace(panel);
  }
  return inverse;
}

Eigen::MatrixXd square_of_lower(const Eigen::MatrixXd& R) {
  const Eigen::Index size = R.rows();
  Eigen::MatrixXd square(size, size);
  for (Eigen::Index first = 0; first < size; first += kPanel) {
    const Eigen::Index width = std::min(kPanel, size - first);
    const auto below = R.bottomRows(size - first);
    square.block(first, 0, width, first + width).noalias() =
        below.middleCols(first, width).transpose() * below.leftCols(first + width);
  }
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  return square;
}

}  // namespace armsig::tool
