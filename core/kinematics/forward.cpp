// SPDX-License-Identifier: MIT
#include "core/kinematics/forward.hpp"

#include "core/kinematics/forward_kernel.hpp"

namespace armsig::kinematics {
namespace {

// Written where the caller wants it, so that nothing is initialised twice: a result declared in an
// inner block would be copied there.
template <typename V, std::size_t kRows>
[[gnu::always_inline]] inline Result<Pose> stored(const FrameBy<V, kRows>& frame) {
  if constexpr (kRows == 1) return Pose{frame.R, frame.p};
  Result<Pose> result;
  frame.store_pose(*result);
  return result;
}

}  // namespace

Result<Pose> forward(const Chain& chain, const JointVector& q) {
  ARMSIG_CHECK(q.size() == chain.joint_count);
  JointTerms terms;
  if (!joint_terms(chain, q.data(), terms)) [[unlikely]] {
    return std::unexpected(Error::kNotFinite);
  }
  Frame frame;
  NoAxes none;
  frame.advance_all(chain, terms, none);
  return stored(frame);
}

Result<PoseAndJacobian> forward_with_jacobian(const Chain& chain, const JointVector& q) {
  ARMSIG_CHECK(q.size() == chain.joint_count);
  Result<PoseAndJacobian> result;
  if (!joint_columns(chain, q.data(), *result)) result = std::unexpected(Error::kNotFinite);
  return result;
}

}  // namespace armsig::kinematics
