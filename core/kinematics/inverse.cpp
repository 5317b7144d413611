// SPDX-License-Identifier: MIT
#include "core/kinematics/inverse.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/kinematics/damped_inverse.hpp"
#include "core/kinematics/newton.hpp"
#include "core/kinematics/verdict.hpp"

namespace armsig::kinematics {
namespace {

bool inside_limits(const Chain& chain, const InverseSolution& solution, const JointVector& seed,
                   const InverseOptions& options) {
  if (options.respect_limits && !chain.limits.empty()) {
    for (std::size_t i = 0; i < seed.size(); ++i) {
      if (solution.q[i] < chain.limits[i].lower || solution.q[i] > chain.limits[i].upper) {
        return false;
      }
    }
  }
  for (std::size_t i = 0; i < options.max_step.size(); ++i) {
    // Written so that a NaN is no step.
    if (!(std::abs(solution.q[i] - seed[i]) <= options.max_step[i])) return false;
  }
  return true;
}

// Whether the last three of six joints are revolute, as the Newton step takes them.
bool has_turning_wrist(const Chain& chain) {
  return chain.joint_count == 6 && chain.revolute[3] && chain.revolute[4] && chain.revolute[5];
}

}  // namespace

Result<InverseSolution> inverse(const Chain& chain, const Pose& X_0n, const JointVector& seed,
                                const InverseOptions& options) {
  ARMSIG_CHECK(seed.size() == chain.joint_count);
  ARMSIG_CHECK(options.max_step.empty() || options.max_step.size() == chain.joint_count);
  // NaN and infinity make any sum of squares fail. R is looked at where the pose is met.
  double squares = X_0n.p.squaredNorm() + options.p_nP.squaredNorm();
  for (const double reading : seed) squares += reading * reading;
  if (!(squares <= kFarthest * kFarthest)) [[unlikely]] {
    if (const auto error = refusal(X_0n, seed, options)) return std::unexpected(*error);
  }
  int passes = 0;
  if (has_turning_wrist(chain)) {
    const auto solution = newton_inverse(chain, X_0n, seed, options, passes);
    if (solution && inside_limits(chain, *solution, seed, options)) return *solution;
  }
  if (const auto error = refusal(X_0n, seed, options)) return std::unexpected(*error);
  return damped_inverse(chain, X_0n, seed, options, passes);
}

}  // namespace armsig::kinematics
