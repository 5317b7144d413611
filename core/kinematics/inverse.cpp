// SPDX-License-Identifier: MIT
#include "core/kinematics/inverse.hpp"

#include <cmath>

#include "core/base/check.hpp"
#include "core/kinematics/damped_inverse.hpp"

namespace armsig::kinematics {

Result<InverseSolution> inverse(const Chain& chain, const Pose& X_0n, const JointVector& seed,
                                const InverseOptions& options) {
  ARMSIG_CHECK(seed.size() == chain.joint_count);
  ARMSIG_CHECK(options.max_step.empty() || options.max_step.size() == chain.joint_count);
  bool finite = X_0n.R.allFinite() && X_0n.p.allFinite();
  for (const double reading : seed) finite = finite && std::isfinite(reading);
  if (!finite) return std::unexpected(Error::kNotFinite);
  return damped_inverse(chain, X_0n, seed, seed, options);
}

}  // namespace armsig::kinematics
