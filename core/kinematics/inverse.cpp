// SPDX-License-Identifier: MIT
#include "core/kinematics/inverse.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/kinematics/damped_inverse.hpp"
#include "core/kinematics/newton.hpp"

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
    if (std::abs(solution.q[i] - seed[i]) > options.max_step[i]) return false;
  }
  return true;
}

}  // namespace

Result<InverseSolution> inverse(const Chain& chain, const Pose& X_0n, const JointVector& seed,
                                const InverseOptions& options) {
  ARMSIG_CHECK(seed.size() == chain.joint_count);
  ARMSIG_CHECK(options.max_step.empty() || options.max_step.size() == chain.joint_count);
  // A number times zero is zero unless it is infinite or NaN.
  double nothing = (0.0 * X_0n.R).sum() + (0.0 * X_0n.p).sum();
  for (const double reading : seed) nothing += 0.0 * reading;
  if (nothing != 0) return std::unexpected(Error::kNotFinite);
  if (chain.joint_count == 6) {
    const auto solution = newton_inverse(chain, X_0n, seed, options);
    if (solution && inside_limits(chain, *solution, seed, options)) return *solution;
  }
  return damped_inverse(chain, X_0n, seed, seed, options);
}

}  // namespace armsig::kinematics
