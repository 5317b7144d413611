// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/kinematics/inverse.hpp"
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/values.hpp"

namespace armsig::selftest {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// How far the seed of an inverse stands from its solution, each joint to another side: rad or m.
constexpr double kSeed = 0.008;

struct Worst {
  double position_m = 0;
  double rotation = 0;
  double inverse_m = 0;
};

void check_pose(const kinematics::Chain& chain, const KnownPose& pose, Worst& worst) {
  const JointVector q = readings(pose.q, chain.joint_count);
  const auto X = kinematics::forward(chain, q);
  if (!X) {
    worst.position_m = kNever;
    return;
  }
  worst.position_m = std::max(worst.position_m, (X->p - vector(pose.p_m)).norm());
  worst.rotation = std::max(worst.rotation, (X->R - matrix(pose.R)).norm());

  JointVector seed = q;
  for (std::size_t i = 0; i < seed.size(); ++i) seed[i] += i % 2 == 0 ? kSeed : -kSeed;
  const auto solution = kinematics::inverse(chain, {matrix(pose.R), vector(pose.p_m)}, seed);
  const bool met = solution && (solution->verdict == kinematics::Verdict::kConverged ||
                                solution->verdict == kinematics::Verdict::kDegraded);
  if (!met) {
    worst.inverse_m = kNever;
    return;
  }
  const auto reached = kinematics::forward(chain, solution->q);
  worst.inverse_m =
      std::max(worst.inverse_m, reached ? (reached->p - vector(pose.p_m)).norm() : kNever);
}

}  // namespace

void check_kinematics(Report& report) {
  Worst worst;
  for (const KnownArm& arm : kArms) {
    const kinematics::Chain chain = kinematics::make_chain(rows(arm.rows, arm.joint_count));
    for (const KnownPose& pose : arm.poses) check_pose(chain, pose, worst);
  }
  report.check("forward_position_nm", 1e9 * worst.position_m, 0.01);
  report.check("forward_rotation_nrad", 1e9 * worst.rotation, 0.001);
  report.check("inverse_position_nm", 1e9 * worst.inverse_m, 1);
}

}  // namespace armsig::selftest
