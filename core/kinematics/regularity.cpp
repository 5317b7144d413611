// SPDX-License-Identifier: MIT
#include "core/kinematics/regularity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace armsig::kinematics {
namespace {

struct Pivot {
  double size = 0;
  Eigen::Index row = 0;
  Eigen::Index column = 0;
};

// The largest entry of rows [row, row_end) and columns [column, columns).
Pivot largest(const Jacobian& m, Eigen::Index row, Eigen::Index row_end, Eigen::Index column,
              Eigen::Index columns) {
  Pivot pivot{0, row, column};
  for (Eigen::Index c = column; c < columns; ++c) {
    for (Eigen::Index r = row; r < row_end; ++r) {
      if (std::abs(m(r, c)) > pivot.size) pivot = {std::abs(m(r, c)), r, c};
    }
  }
  return pivot;
}

}  // namespace

Regularity regularity(const PoseAndJacobian& J, double threshold) {
  const auto columns = static_cast<Eigen::Index>(J.joint_count);
  Jacobian m = J.J;
  double reach = 0;
  for (Eigen::Index c = 0; c < columns; ++c) reach = std::max(reach, m.col(c).head<3>().norm());
  if (reach > 0) m.topRows<3>() /= reach;

  Regularity result{.value = 1};
  Eigen::Index used = 0;  // columns that hold a pivot, moved to the front
  double left_over = 0;
  // Within a block the rows that hold a pivot move to its front; those of the position block that
  // hold none are dropped.
  const auto eliminate = [&](Eigen::Index begin, Eigen::Index end) {
    int dimensions = 0;
    for (Eigen::Index row = begin; row < end && used < columns; ++row) {
      const Pivot pivot = largest(m, row, end, used, columns);
      if (pivot.size < threshold) {
        left_over = std::max(left_over, pivot.size);
        break;
      }
      result.value = std::min(result.value, pivot.size);
      m.row(row).swap(m.row(pivot.row));
      m.col(used).swap(m.col(pivot.column));
      for (Eigen::Index r = row + 1; r < 6; ++r) {
        const double factor = m(r, used) / m(row, used);
        for (Eigen::Index c = used; c < columns; ++c) m(r, c) -= factor * m(row, c);
      }
      ++used;
      ++dimensions;
    }
    return dimensions;
  };
  result.position_dimensions = eliminate(0, 3);
  result.rotation_dimensions = eliminate(3, 6);
  if (used < std::min<Eigen::Index>(columns, 6)) result.value = left_over;
  return result;
}

}  // namespace armsig::kinematics
