// SPDX-License-Identifier: MIT
// The tool of a signature: where its target on the hand is.
#include "firmware/controller/model.hpp"

#include <gtest/gtest.h>

#include "core/identification.hpp"
#include "firmware/paper_arms/paper_arms.hpp"
#include "host_tests/support/failure_of.hpp"
#include "host_tests/support/not_finite.hpp"

namespace armsig::controller {
namespace {

const KnownTarget kOnTheHand{2, 6, Vector3(0.1, -0.05, 0.2)};
const JointVector kAt{0.1, -1, 1, 0.2, 0.3, 0.4};

Signature with_targets(std::span<const KnownTarget> targets) {
  return signature_of(tool::puma560(), kAt, Pose{rotation_z(0.3), Vector3(1, 2, 0)}, targets);
}

TEST(Model, has_its_tool_at_the_first_target_on_the_hand) {
  const std::array<KnownTarget, 2> targets{KnownTarget{1, 3, Vector3(0, 0, 0.1)}, kOnTheHand};
  const Signature signature = with_targets(targets);
  const Model model = model_of(signature, tool::puma560());
  EXPECT_TRUE(model.identified);
  EXPECT_LT((tool_pose(model, kAt)->p - signature.targets[1].p_S).norm(), 1e-12);
}

TEST(Model, without_a_target_on_the_hand_has_its_tool_at_the_last_frame) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}}) {
    const KnownTarget on_the_arm{1, 3, Vector3(0, 0, 0.1)};
    const Model model = model_of(with_targets({&on_the_arm, count}), tool::puma560());
    EXPECT_EQ(model.p_nT, Vector3::Zero()) << count;
  }
}

TEST(Model, without_a_finite_configuration_has_no_tool_that_is_no_number) {
  Signature signature = with_targets({&kOnTheHand, 1});
  signature.configuration[2] = test::kNan;
  EXPECT_EQ(model_of(signature, tool::puma560()).p_nT, Vector3::Zero());
}

}  // namespace
}  // namespace armsig::controller
