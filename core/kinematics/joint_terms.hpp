// SPDX-License-Identifier: MIT
// What the forward kinematics needs of the readings: the sines and cosines of all joints together.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/base/lanes.hpp"
#include "core/base/sine_cosine.hpp"
#include "core/kinematics/chain.hpp"

namespace armsig::kinematics {
inline namespace ARMSIG_LANES {

// Sine and cosine of each joint angle, and the height of each link along the joint axis.
struct JointTerms {
  alignas(32) std::array<double, kMaxJoints> sine;
  alignas(32) std::array<double, kMaxJoints> cosine;
  std::array<Broadcast, kMaxJoints> height;  // set where the chain has a prismatic joint
  const Broadcast* z;
};

// Where the chain has a prismatic joint: its reading lengthens the link. False if a reading is not
// finite.
[[gnu::noinline]] inline bool prismatic_heights(const Chain& chain, const double* q,
                                                JointTerms& terms) {
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!std::isfinite(q[i])) return false;
    terms.height[i] = chain.z[i] + (chain.revolute[i] ? 0.0 : q[i]);
  }
  return true;
}

// Angles beyond the reach of the polynomials are left to the library. False if a reading is not
// finite.
[[gnu::noinline, gnu::cold]] inline bool large_angles(const Chain& chain, const double* q,
                                                      JointTerms& terms) {
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!std::isfinite(q[i])) return false;
    const double angle = chain.theta[i] + (chain.revolute[i] ? q[i] : 0);
    terms.sine[i] = std::sin(angle);
    terms.cosine[i] = std::cos(angle);
  }
  return true;
}

// One pack of joints from joint j on. Returns a mask of the angles that are neither too large nor
// NaN.
[[nodiscard]] [[gnu::always_inline]] inline PackMask<double> pack_terms(const Chain& chain,
                                                                        const double* q,
                                                                        JointTerms& terms,
                                                                        std::size_t j) {
  using V = Pack<double>;
  using Bits = PackMask<double>;
  constexpr auto kNoSign = std::numeric_limits<std::int64_t>::max();
  // The mask clears prismatic readings and whatever stands beyond the last joint.
  const Bits bits = load<Bits>(q + j) & load<Bits>(chain.revolute_bits.data() + j);
  const V angle = bits_as<V>(bits) + load<V>(chain.theta.data() + j);
  V sine;
  V cosine;
  sine_cosine(angle, sine, cosine);
  store(terms.sine.data() + j, sine);
  store(terms.cosine.data() + j, cosine);
  return (bits_as<V>(bits_as<Bits>(angle) & kNoSign) <= SineCosineConstants<double>::kLargestAngle);
}

// Sines, cosines and heights at readings q (room for kMaxJoints numbers). False if one is not
// finite.
[[nodiscard]] [[gnu::always_inline]] inline bool joint_terms(const Chain& chain, const double* q,
                                                             JointTerms& terms) {
  constexpr std::size_t kCount = Lanes<double>::kCount;
  terms.z = chain.z.data();
  if (chain.has_prismatic) [[unlikely]] {
    if (!prismatic_heights(chain, q, terms)) return false;
    terms.z = terms.height.data();
  }
  if constexpr (kCount == 1) {
    for (std::size_t j = 0; j < chain.joint_count; ++j) {
      double angle = chain.theta[j];
      if (chain.revolute[j]) [[likely]]
        angle += q[j];
      if (!(std::abs(angle) <= SineCosineConstants<double>::kLargestAngle)) [[unlikely]] {
        return large_angles(chain, q, terms);
      }
      sine_cosine_of_one(angle, terms.sine[j], terms.cosine[j]);
    }
    return true;
  }
  PackMask<double> in_reach = ~PackMask<double>{};
  if constexpr (2 * kCount == kMaxJoints) {
    // Both packs at once: their work overlaps, and the constants are loaded once.
    in_reach = pack_terms(chain, q, terms, 0) & pack_terms(chain, q, terms, kCount);
  } else {
    for (std::size_t j = 0; j < chain.joint_count; j += kCount)
      in_reach &= pack_terms(chain, q, terms, j);
  }
  return all(in_reach) || large_angles(chain, q, terms);
}

}  // namespace ARMSIG_LANES
}  // namespace armsig::kinematics
