// SPDX-License-Identifier: MIT
#include "core/kinematics/forward.hpp"

#include "core/kinematics/forward_kernel.hpp"

namespace armsig::kinematics {
namespace {

// Written where the caller wants it, so that nothing is initialised twice: a result declared in an
// inner block would be copied there.
template <typename Scalar>
[[gnu::always_inline]] inline Result<PoseT<Scalar>> stored(const Frame<Scalar>& frame) {
  Result<PoseT<Scalar>> result;
  frame.store_pose(*result);
  return result;
}

template <typename Scalar>
  requires(Lanes<Scalar>::kCount == 1)
[[gnu::always_inline]] inline Result<PoseT<Scalar>> stored(const Frame<Scalar>& frame) {
  return PoseT<Scalar>{frame.R, frame.p};
}

template <typename Scalar>
[[gnu::always_inline]] inline Result<PoseT<Scalar>> pose(const ChainT<Scalar>& chain,
                                                         const ReadingsT<Scalar>& q) {
  ARMSIG_CHECK(q.size() == chain.joint_count);
  JointTerms<Scalar> terms;
  if (!joint_terms(chain, q.data(), terms)) [[unlikely]] {
    return std::unexpected(Error::kNotFinite);
  }
  Frame<Scalar> frame;
  NoAxes none;
  frame.advance_all(chain, terms, none);
  return stored(frame);
}

template <typename Scalar>
[[gnu::always_inline]] inline Result<PoseAndJacobianT<Scalar>> pose_and_jacobian(
    const ChainT<Scalar>& chain, const ReadingsT<Scalar>& q) {
  ARMSIG_CHECK(q.size() == chain.joint_count);
  Result<PoseAndJacobianT<Scalar>> result;
  if (!joint_columns(chain, q.data(), *result)) result = std::unexpected(Error::kNotFinite);
  return result;
}

}  // namespace

Result<Pose> forward(const Chain& chain, const JointVector& q) { return pose(chain, q); }

Result<PoseT<float>> forward(const ChainT<float>& chain, const ReadingsT<float>& q) {
  return pose(chain, q);
}

Result<PoseAndJacobian> forward_with_jacobian(const Chain& chain, const JointVector& q) {
  return pose_and_jacobian(chain, q);
}

Result<PoseAndJacobianT<float>> forward_with_jacobian(const ChainT<float>& chain,
                                                      const ReadingsT<float>& q) {
  return pose_and_jacobian(chain, q);
}

}  // namespace armsig::kinematics
