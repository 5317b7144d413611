// SPDX-License-Identifier: MIT
#include "core/kinematics/regularity.hpp"

#include <algorithm>

#include "core/kinematics/position_first.hpp"
#include "core/numerics/cholesky.hpp"

namespace armsig::kinematics {

double regularity(const Chain& chain, const PoseAndJacobian& at) {
  Jacobian J = at.J;
  J.topRows<3>() /= chain.length;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!chain.revolute[i]) J.col(static_cast<Eigen::Index>(i)) *= chain.length;
  }
  if (chain.position_first) {
    return PositionFirst(J).volume(static_cast<Eigen::Index>(chain.joint_count));
  }
  const auto size = static_cast<Eigen::Index>(std::min<std::size_t>(chain.joint_count, 6));
  numerics::Square gram = numerics::Square::Zero();
  if (size < 6) {
    gram = J.transpose().lazyProduct(J);
  } else {
    gram.topLeftCorner<6, 6>() = J.lazyProduct(J.transpose());
  }
  if (!numerics::factor_positive(gram, size)) return 0;
  double volume = 1;
  for (Eigen::Index i = 0; i < size; ++i) volume *= gram(i, i);
  return volume;
}

}  // namespace armsig::kinematics
