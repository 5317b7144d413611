// SPDX-License-Identifier: MIT
#include "core/refinement/swept_path.hpp"

#include <gtest/gtest.h>

#include "host_tests/support/simulated_arm.hpp"

namespace armsig::refinement {
namespace {

using test::Cell;
using test::Random;

// What all of the sweeps start from.
struct Start {
  explicit Start(Random& random)
      : cell(test::mixed_cell(random)),
        configuration(random.configuration(cell.arm)),
        signature(test::signature_of(cell, configuration)),
        layout(make_layout(signature, {true}, {}, 0).value()),
        chain(signature, {}) {}

  Cell cell;
  JointVector configuration;
  Signature signature;
  Layout layout;
  Chain chain;
};

SweptJoint swept_joint(const Signature& signature, const Chain& chain, std::size_t joint,
                       const JointVector& q) {
  SweptJoint swept;
  swept.joint = joint;
  swept.revolute = signature.types[joint] == JointType::kRevolute;
  swept.half_length = 0.4;
  swept.middle = chain.motion(q);
  return swept;
}

// [1, cos d, sin d] or [1, d / h, 0].
Vector3 regressors(const SweptJoint& swept, double d) {
  if (swept.revolute) return {1, std::cos(d), std::sin(d)};
  return {1, d / swept.half_length, 0};
}

// At the signature configuration but for the swept joint, or anywhere.
JointVector held(const Cell& cell, const JointVector& configuration, bool anywhere,
                 std::size_t joint, Random& random) {
  JointVector q = random.configuration(cell.arm);
  for (std::size_t i = 0; i < q.size(); ++i) {
    if (i != joint && !anywhere) q[i] = configuration[i];
  }
  return q;
}

TEST(SweptPath, is_where_the_chain_puts_the_target_along_the_sweep) {
  Random random(31);
  const auto [cell, configuration, signature, layout, chain] = Start(random);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    for (const bool anywhere : {false, true}) {
      JointVector q = held(cell, configuration, anywhere, joint, random);
      const SweptJoint swept = swept_joint(signature, chain, joint, q);
      const SweptPath path = swept_path(signature, chain, swept, signature.targets[0]);
      const double middle = q[joint];
      for (const double d : {-0.4, 0.1, 0.3}) {
        q[joint] = middle + d;
        const Vector3 p = path.X_SF * Vector3(path.rows.transpose() * regressors(swept, d));
        EXPECT_LT((p - chain.point(chain.motion(q), signature.targets[0])).norm(), 1e-13);
      }
    }
  }
}

// Against those of the chain at single poses, which are tested against differences.
TEST(SweptPath, derivatives_are_those_of_the_chain_along_the_sweep) {
  Random random(32);
  const auto [cell, configuration, signature, layout, chain] = Start(random);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    for (const bool anywhere : {false, true}) {
      JointVector q = held(cell, configuration, anywhere, joint, random);
      const SweptJoint swept = swept_joint(signature, chain, joint, q);
      const SweptPath path = swept_path(signature, chain, swept, signature.targets[0]);
      PathDerivatives derivatives;
      path_derivatives(layout, signature, chain, swept, 0, path, derivatives);
      EXPECT_EQ(derivatives.columns.size(),
                anywhere ? layout.size() : (swept.revolute ? 4U : 2U) + 3U);
      EXPECT_TRUE(std::ranges::is_sorted(derivatives.columns));

      const double middle = q[joint];
      for (const double d : {-0.4, 0.1, 0.3}) {
        q[joint] = middle + d;
        const JointMotion motion = chain.motion(q);
        PointJacobian jacobian;
        chain.point_and_jacobian(motion, signature.targets[0], jacobian);
        RowBlock<3> expected;
        expected.clear(layout.size());
        add_derivatives(layout, signature, chain, motion, 0, jacobian, 1.0, expected);
        const Vector3 f = regressors(swept, d);
        for (std::size_t j = 0; j < derivatives.columns.size(); ++j) {
          Vector3 by_F = Vector3::Zero();
          Vector3 by_S;
          for (int i = 0; i < 3; ++i) {
            for (int k = 0; k < 3; ++k) by_F[i] += f[k] * derivatives.rows.rows[3 * k + i][j];
            by_S[i] = expected.rows[i][derivatives.columns[j]];
          }
          EXPECT_LT((path.X_SF.R * by_F - by_S).norm(), 1e-13)
              << "joint " << joint + 1 << ", unknown " << +derivatives.columns[j];
        }
      }
    }
  }
}

TEST(SweptPath, radius_is_the_distance_of_the_target_from_the_axis) {
  Random random(33);
  const auto [cell, configuration, signature, layout, chain] = Start(random);
  for (std::size_t joint = 0; joint < 6; ++joint) {
    const JointVector q = held(cell, configuration, false, joint, random);
    const SweptJoint swept = swept_joint(signature, chain, joint, q);
    const SweptPath path = swept_path(signature, chain, swept, signature.targets[0]);
    PathDerivatives derivatives;
    path_derivatives(layout, signature, chain, swept, 0, path, derivatives);
    const Pose& X_SL = signature.X_SL[joint];
    const Vector3 from_axis = signature.targets[0].p_S - X_SL.p;
    const double expected = swept.revolute ? from_axis.cross(X_SL.R.col(2)).norm() : 1;
    EXPECT_NEAR(derivatives.radius[joint], expected, 1e-13);
  }
}

}  // namespace
}  // namespace armsig::refinement
