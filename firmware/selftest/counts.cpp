// SPDX-License-Identifier: MIT
#include <cmath>

#include "core/features/rls.hpp"
#include "core/kinematics/inverse.hpp"
#include "core/kinematics/s_model_chain.hpp"
#include "firmware/selftest/checks.hpp"
#include "firmware/selftest/scratch.hpp"
#include "firmware/selftest/values.hpp"

namespace armsig::selftest {
namespace {

constexpr std::uint32_t kCalls = 64;

// The work: robot 1 of Table 2, whose d is 112 m.
const KnownArm& arm() {
  for (const KnownArm& known : kArms) {
    if (std::string_view(known.name) == "puma560-stone1986-robot1") return known;
  }
  __builtin_trap();
}

template <typename Scalar>
double instructions_of_rls() {
  using Rls = features::SquareRootRls<3, 3, Scalar>;
  struct Row {
    typename Rls::Regressors x;
    typename Rls::RightHandSides y;
  };
  static std::array<Row, kPoints> rows;
  for (std::size_t k = 0; k < kPoints; ++k) {
    const SweptPoint& point = kSwept.sweeps[0][k];
    rows[k].x << Scalar(1), static_cast<Scalar>(std::cos(point.reading)),
        static_cast<Scalar>(std::sin(point.reading));
    rows[k].y = vector(point.p_S).cast<Scalar>();
  }
  Rls rls;
  return instructions_of(kCalls, [&](std::uint32_t k) {
    rls.update(rows[k % kPoints].x, rows[k % kPoints].y);
    keep(rls);
  });
}

struct Work {
  kinematics::Chain chain;
  std::array<JointVector, kPoses> q;
  std::array<JointVector, kPoses> seed;
  std::array<Pose, kPoses> X_0n;
};

// Seeds half a degree away in every joint: the step of a fast arm in some ticks.
const Work& work() {
  Work& result = in_scratch<Work>();
  const KnownArm& known = arm();
  result.chain = kinematics::make_chain(rows(known.rows, known.joint_count));
  for (std::size_t k = 0; k < kPoses; ++k) {
    const KnownPose& pose = known.poses[k];
    result.q[k] = result.seed[k] = readings(pose.q, known.joint_count);
    for (std::size_t i = 0; i < known.joint_count; ++i) {
      result.seed[k][i] += radians((i + k) % 2 == 0 ? 0.5 : -0.5);
    }
    result.X_0n[k] = {matrix(pose.R), vector(pose.p_m)};
  }
  return result;
}

}  // namespace

void count_double(Report& report) {
  const Work& w = work();
  report.count("rls_update", instructions_of_rls<double>());
  report.count("forward", instructions_of(kCalls, [&](std::uint32_t k) {
                 auto X = kinematics::forward(w.chain, w.q[k % kPoses]);
                 keep(X);
               }));
  report.count("forward_with_jacobian", instructions_of(kCalls, [&](std::uint32_t k) {
                 auto X = kinematics::forward_with_jacobian(w.chain, w.q[k % kPoses]);
                 keep(X);
               }));
  double iterations = 0;
  const double inverse = instructions_of(kCalls, [&](std::uint32_t k) {
    auto solution = kinematics::inverse(w.chain, w.X_0n[k % kPoses], w.seed[k % kPoses]);
    iterations += solution->iterations;
    keep(solution);
  });
  report.count("inverse_from_half_a_degree", inverse);
  report.count("inverse_step", inverse / (iterations / kCalls));
}

void count_single(Report& report) {
  const KnownArm& known = arm();
  const auto chain = kinematics::chain_of<float>(signature_of_known(known));
  const Work& w = work();
  report.count("rls_update_single", instructions_of_rls<float>());
  report.count("forward_single", instructions_of(kCalls, [&](std::uint32_t k) {
                 PoseT<float> X = kinematics::link_pose(chain, w.q[k % kPoses], known.joint_count);
                 keep(X);
               }));
}

}  // namespace armsig::selftest
