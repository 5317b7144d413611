// SPDX-License-Identifier: MIT
#include "core/kinematics/forward.hpp"

#include <cmath>

#include "core/base/check.hpp"

namespace armsig::kinematics {
namespace {

template <typename Scalar>
Result<PoseAndJacobianT<Scalar>> evaluate(const ChainT<Scalar>& chain,
                                          const FixedVector<Scalar, kMaxJoints>& q) {
  using Vector = Eigen::Matrix<Scalar, 3, 1>;
  ARMSIG_CHECK(q.size() == chain.joint_count);
  PoseAndJacobianT<Scalar> result;
  result.joint_count = chain.joint_count;
  PoseT<Scalar>& X = result.X_0n;
  Eigen::Matrix<Scalar, 3, kMaxJoints> p_0;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!std::isfinite(q[i])) return std::unexpected(Error::kNotFinite);
    const auto column = static_cast<Eigen::Index>(i);
    p_0.col(column) = X.p;
    result.J.col(column).template tail<3>() = X.R.col(2);
    const Scalar theta = chain.theta[i] + (chain.revolute[i] ? q[i] : Scalar(0));
    const Scalar c = std::cos(theta);
    const Scalar s = std::sin(theta);
    const Vector x = c * X.R.col(0) + s * X.R.col(1);
    const Vector y = c * X.R.col(1) - s * X.R.col(0);
    const Vector z = X.R.col(2);
    X.p +=
        chain.x[i] * x + chain.y[i] * y + (chain.z[i] + (chain.revolute[i] ? Scalar(0) : q[i])) * z;
    X.R.col(0) = x;
    X.R.col(1) = chain.cos_alpha[i] * y + chain.sin_alpha[i] * z;
    X.R.col(2) = chain.cos_alpha[i] * z - chain.sin_alpha[i] * y;
  }
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    auto column = result.J.col(static_cast<Eigen::Index>(i));
    const Vector axis = column.template tail<3>();
    if (chain.revolute[i]) {
      column.template head<3>() = axis.cross(X.p - p_0.col(static_cast<Eigen::Index>(i)));
    } else {
      column.template head<3>() = axis;
      column.template tail<3>().setZero();
    }
  }
  return result;
}

}  // namespace

Result<Pose> forward(const Chain& chain, const JointVector& q) {
  ARMSIG_TRY(result, evaluate(chain, q));
  return result.X_0n;
}

Result<PoseT<float>> forward(const ChainT<float>& chain, const ReadingsT<float>& q) {
  ARMSIG_TRY(result, evaluate(chain, q));
  return result.X_0n;
}

Result<PoseAndJacobian> forward_with_jacobian(const Chain& chain, const JointVector& q) {
  return evaluate(chain, q);
}

Result<PoseAndJacobianT<float>> forward_with_jacobian(const ChainT<float>& chain,
                                                      const ReadingsT<float>& q) {
  return evaluate(chain, q);
}

}  // namespace armsig::kinematics
