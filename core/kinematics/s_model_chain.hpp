// SPDX-License-Identifier: MIT
// Poses from the link frames themselves: T(q) = S_0 prod_i motion_i(q_i - q_i^s) B_i, (M7) of
// docs/model.md. Unlike the pseudo Denavit-Hartenberg product it has no large numbers near parallel
// axes, so that it also serves in single precision, and it is exact where axes are parallel within
// 1e-8.
#pragma once

#include <cstddef>

#include "core/base/sine_cosine.hpp"
#include "core/signature.hpp"

namespace armsig::kinematics {

// What the evaluation needs, in its own precision.
template <typename Scalar>
struct SModelChain {
  JointTypes types;
  JointVector configuration;                 // double: readings are subtracted before rounding
  PoseT<Scalar> X_S0;                        // link frame 0 in the sensor frame
  FixedVector<PoseT<Scalar>, kMaxJoints> B;  // (18), from the link frames, not from parameters
};

template <typename Scalar>
[[nodiscard]] PoseT<Scalar> cast(const Pose& X) {
  return {X.R.template cast<Scalar>(), X.p.template cast<Scalar>()};
}

// Link frames 0 ... n at readings `configuration`.
template <typename Scalar>
[[nodiscard]] SModelChain<Scalar> chain_of(const JointTypes& types,
                                           const JointVector& configuration,
                                           const FixedVector<Pose, kMaxFrames>& X_SL) {
  SModelChain<Scalar> chain;
  chain.types = types;
  chain.configuration = configuration;
  chain.X_S0 = cast<Scalar>(X_SL[0]);
  for (std::size_t i = 0; i < types.size(); ++i) {
    chain.B.push_back(cast<Scalar>(X_SL[i].inverse() * X_SL[i + 1]));
  }
  return chain;
}

template <typename Scalar>
[[nodiscard]] SModelChain<Scalar> chain_of(const Signature& signature) {
  return chain_of<Scalar>(signature.types, signature.configuration, signature.X_SL);
}

// Pose of link frame `link` (0 ... n) in the sensor frame at effective readings q.
// Preconditions: one reading a joint; link at most n.
template <typename Scalar>
[[nodiscard]] PoseT<Scalar> link_pose(const SModelChain<Scalar>& chain, const JointVector& q,
                                      std::size_t link) {
  ARMSIG_CHECK(q.size() == chain.types.size() && link <= chain.types.size());
  PoseT<Scalar> X_SL = chain.X_S0;
  for (std::size_t i = 0; i < link; ++i) {
    const auto moved = static_cast<Scalar>(q[i] - chain.configuration[i]);
    if (chain.types[i] == JointType::kRevolute) {
      const auto [s, c] = sine_and_cosine(moved);
      const Eigen::Matrix<Scalar, 3, 1> x = X_SL.R.col(0);
      X_SL.R.col(0) = c * x + s * X_SL.R.col(1);
      X_SL.R.col(1) = c * X_SL.R.col(1) - s * x;
    } else {
      X_SL.p += moved * X_SL.R.col(2);
    }
    X_SL = X_SL * chain.B[i];
  }
  return X_SL;
}

[[nodiscard]] Pose link_pose(const Signature& signature, const JointVector& q, std::size_t link);

// Where a target of the signature is at effective readings q, in the sensor frame.
[[nodiscard]] Vector3 target_position(const Signature& signature, const JointVector& q,
                                      const Target& target);

}  // namespace armsig::kinematics
