// SPDX-License-Identifier: MIT
#include "core/kinematics/regularity.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/numerics/cholesky.hpp"

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

// sqrt(det(J J^T)) or, of fewer than six columns, sqrt(det(J^T J)).
double volume(const Jacobian& J, Eigen::Index columns) {
  numerics::Square gram = numerics::Square::Zero();
  if (columns < 6) {
    gram = J.transpose().lazyProduct(J);
  } else {
    gram.topLeftCorner<6, 6>() = J.lazyProduct(J.transpose());
  }
  const Eigen::Index size = std::min<Eigen::Index>(columns, 6);
  if (!numerics::factor_positive(gram, size)) return 0;
  double product = 1;
  for (Eigen::Index i = 0; i < size; ++i) product *= gram(i, i);
  return product;
}

}  // namespace

Regularity regularity(const Chain& chain, const PoseAndJacobian& at, double threshold) {
  const auto columns = static_cast<Eigen::Index>(chain.joint_count);
  Jacobian m = at.J;
  m.topRows<3>() /= chain.length;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!chain.revolute[i]) m.col(static_cast<Eigen::Index>(i)) *= chain.length;
  }

  Regularity result{.value = volume(m, columns)};
  Eigen::Index used = 0;  // columns that hold a pivot, moved to the front
  // Within a block the rows that hold a pivot move to its front; those of the position block that
  // hold none are dropped.
  const auto eliminate = [&](Eigen::Index begin, Eigen::Index end) {
    int dimensions = 0;
    for (Eigen::Index row = begin; row < end && used < columns; ++row) {
      const Pivot pivot = largest(m, row, end, used, columns);
      if (pivot.size < threshold) break;
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
  return result;
}

}  // namespace armsig::kinematics
