// SPDX-License-Identifier: MIT
// From C++: a simulated arm is swept joint by joint, its signature is found from the points, and
// the servo's kinematics run on it. Build: find_package(armsig), link armsig::core. No heap, no
// exceptions.
#include <cstdio>

#include "core/features/sweep_estimator.hpp"
#include "core/identification.hpp"
#include "core/kinematics/inverse.hpp"
#include "core/kinematics/s_model_chain.hpp"

using namespace armsig;

namespace {

constexpr int kPoints = 36;

// The nominal model: a shoulder, an elbow and a wrist, radians and metres.
Arm drawing() {
  Arm arm;
  arm.joints = {{JointType::kRevolute, 0, 0.4, 0.025, -kPi / 2},
                {JointType::kRevolute, 0, 0, 0.455, 0},
                {JointType::kRevolute, 0, 0, 0.42, 0}};
  arm.limits = {{-3, 3}, {-2, 2}, {-2, 2}};
  return arm;
}

// What the instrument would say of the target: the arm as built stands in its frame, the elbow is 1
// mm longer than drawn.
Vector3 measured(const JointVector& q) {
  Arm built = drawing();
  built.joints[1].a_m += 0.001;
  const Signature truth = signature_of(built, {0, 0, 0}, Pose{}, {});
  return kinematics::link_pose(truth, q, 3).p;
}

}  // namespace

int main() {
  const JointVector configuration{0.2, -0.5, 1.1};
  FixedVector<features::JointFeature, kMaxJoints> features;

  // README: begin
  for (std::size_t joint = 0; joint < 3; ++joint) {
    features::SweepEstimator sweep({.type = JointType::kRevolute});  // 15 kB, however many points
    for (int k = 0; k < kPoints; ++k) {
      JointVector q = configuration;
      q[joint] += 0.05 * k;
      if (!sweep.add(q[joint], measured(q), Matrix3::Zero())) return 1;
    }
    const auto feature = sweep.estimate();
    if (!feature) return 1;  // feature.error() names the reason, what was found and what is needed
    features.push_back(*feature);
  }
  const auto signature = identify(features, configuration, drawing());
  if (!signature) return 1;
  const kinematics::Chain arm = kinematics::make_chain(signature->pseudo_dh);
  const auto X_0n = kinematics::forward(arm, {0.3, -0.4, 0.9});            // where the tool is
  const auto back = kinematics::inverse(arm, *X_0n, {0.31, -0.41, 0.91});  // and how to get there
  // README: end

  if (!X_0n || !back || back->verdict != kinematics::Verdict::kConverged) return 1;
  std::printf("elbow %.3f mm, readings %.6f %.6f %.6f\n", 1e3 * signature->pseudo_dh[1].a_m,
              back->q[0], back->q[1], back->q[2]);
}
