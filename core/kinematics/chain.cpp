// SPDX-License-Identifier: MIT
#include "core/kinematics/chain.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/check.hpp"
#include "core/base/pose.hpp"
#include "core/kinematics/position_first.hpp"

namespace armsig::kinematics {
namespace {

// Axes within 60 degrees of parallel have their frame moved. Sliding to the height of the previous
// frame then costs at most a doubling of length, and where the axes are nearer to perpendicular
// than this the common normal is never far.
constexpr double kLeastCosine = 0.5;

// How far prismatic joint i can lengthen its link; 0 where nothing bounds it.
double stroke(const Chain& chain, std::size_t i) {
  if (chain.revolute[i] || chain.limits.empty()) return 0;
  const double most = std::max(-chain.limits[i].lower, chain.limits[i].upper);
  return std::isfinite(most) ? std::max(most, 0.0) : 0;
}

double unit_length(const Chain& chain) {
  constexpr double kShare = 0.4;
  double stretched = 0;
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    const double z = std::abs(chain.z[i]) + stroke(chain, i);
    stretched += std::sqrt(chain.x[i] * chain.x[i] + chain.y[i] * chain.y[i] + z * z);
  }
  return stretched > 0 ? kShare * stretched : 1;
}

}  // namespace

Chain make_chain(const DhRows& rows, const FixedVector<JointLimits, kMaxJoints>& limits) {
  ARMSIG_CHECK(!rows.empty());
  ARMSIG_CHECK(limits.empty() || limits.size() == rows.size());
  Chain chain;
  chain.joint_count = rows.size();
  chain.limits = limits;
  double slide = 0;  // of frame i - 1 along its z axis
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const DhJoint& row = rows[i];
    const double c = std::cos(row.alpha_rad);
    const double s = std::sin(row.alpha_rad);
    const double d = row.d_m - slide;
    const bool last = i + 1 == rows.size();
    slide = !last && std::abs(c) > kLeastCosine ? -std::copysign(d, c * d) : 0;
    // Rot(z, theta) Trans(a, 0, d) Rot(x, alpha) Trans(0, 0, slide), with the slide moved to the
    // left of Rot(x, alpha). The slide is +-d, not d / cos(alpha): then d + slide cos(alpha) is
    // d (1 - |cos(alpha)|), which keeps its digits however large d is.
    const double half_sine = c > 0 ? std::sin(0.5 * row.alpha_rad) : std::cos(0.5 * row.alpha_rad);
    chain.theta[i] = row.theta_rad;
    chain.x[i] = row.a_m;
    chain.y[i] = -slide * s;
    chain.z[i] = slide == 0 ? d : 2 * d * half_sine * half_sine;
    chain.cos_alpha[i] = c;
    chain.sin_alpha[i] = s;
    chain.revolute[i] = row.type == JointType::kRevolute;
    chain.revolute_bits[i] = chain.revolute[i] ? -1 : 0;
    chain.has_prismatic = chain.has_prismatic || !chain.revolute[i];
    if (!limits.empty()) ARMSIG_CHECK(limits[i].lower <= limits[i].upper);
  }
  chain.length = unit_length(chain);
  chain.position_first = is_position_first(chain);
  return chain;
}

}  // namespace armsig::kinematics
