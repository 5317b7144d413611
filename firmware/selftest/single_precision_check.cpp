// SPDX-License-Identifier: MIT
#include <algorithm>

#include "core/kinematics/s_model_chain.hpp"
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/values.hpp"

namespace armsig::selftest {
namespace {

// A pose of many that stand in no table: joint i reads what it does in known pose k + shift * i.
JointVector mixed(const KnownArm& known, std::size_t k, std::size_t shift) {
  JointVector q;
  for (std::size_t i = 0; i < known.joint_count; ++i) {
    q.push_back(known.poses[(k + shift * i) % kPoses].q[i]);
  }
  return q;
}

}  // namespace

void check_single_precision(Report& report) {
  double from_answer_m = 0;
  double from_double_m = 0;
  for (const KnownArm& known : kArms) {
    // A committed signature is turned into the chain once.
    const Signature& signature = signature_of_known(known);
    const auto chain = kinematics::chain_of<float>(signature);
    const auto in_double = kinematics::chain_of<double>(signature);
    const auto position = [&](const JointVector& q) {
      return Vector3(kinematics::link_pose(chain, q, known.joint_count).p.cast<double>());
    };
    for (std::size_t k = 0; k < kPoses; ++k) {
      const Vector3 answer = vector(known.poses[k].p_m);
      from_answer_m = std::max(from_answer_m, (position(mixed(known, k, 0)) - answer).norm());
      for (std::size_t shift = 1; shift < kPoses; ++shift) {
        const JointVector q = mixed(known, k, shift);
        const Vector3 p = kinematics::link_pose(in_double, q, known.joint_count).p;
        from_double_m = std::max(from_double_m, (position(q) - p).norm());
      }
    }
  }
  report.check("single_precision_um", 1e6 * from_answer_m, 5);
  report.check("single_from_double_um", 1e6 * from_double_m, 5);
}

}  // namespace armsig::selftest
