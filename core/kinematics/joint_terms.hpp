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

// Sine and cosine of each joint angle, and the height of each link
// along the joint axis.
template <typename Scalar>
struct JointTerms {
  alignas(32) std::array<Scalar, kMaxJoints> sine;
  alignas(32) std::array<Scalar, kMaxJoints> cosine;
  std::array<Broadcast<Scalar>, kMaxJoints> height;  // set where the chain has a prismatic joint
  const Broadcast<Scalar>* z;
};

// Where the chain has a prismatic joint: its reading lengthens the link. False if a reading is not
// finite.
template <typename Scalar>
[[gnu::noinline]] bool prismatic_heights(const ChainT<Scalar>& chain, const Scalar* q,
                                         JointTerms<Scalar>& terms) {
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!std::isfinite(q[i])) return false;
    terms.height[i] = chain.z[i] + (chain.revolute[i] ? Scalar(0) : q[i]);
  }
  return true;
}

// Angles beyond the reach of the polynomials are left to the library. False if a reading is not
// finite.
template <typename Scalar>
[[gnu::noinline, gnu::cold]] bool large_angles(const ChainT<Scalar>& chain, const Scalar* q,
                                               JointTerms<Scalar>& terms) {
  for (std::size_t i = 0; i < chain.joint_count; ++i) {
    if (!std::isfinite(q[i])) return false;
    const double angle =
        static_cast<double>(chain.theta[i]) + (chain.revolute[i] ? static_cast<double>(q[i]) : 0.0);
    terms.sine[i] = static_cast<Scalar>(std::sin(angle));
    terms.cosine[i] = static_cast<Scalar>(std::cos(angle));
  }
  return true;
}

// One pack of joints from joint j on. Returns a mask of the angles that are neither too large nor
// NaN.
template <typename Scalar>
[[nodiscard]] [[gnu::always_inline]] inline PackMask<Scalar> pack_terms(const ChainT<Scalar>& chain,
                                                                        const Scalar* q,
                                                                        JointTerms<Scalar>& terms,
                                                                        std::size_t j) {
  using V = Pack<Scalar>;
  using Bits = PackMask<Scalar>;
  constexpr auto kNoSign = std::numeric_limits<typename Lanes<Scalar>::Integer>::max();
  // The mask clears prismatic readings and whatever stands beyond the last joint.
  const Bits bits = load<Bits>(q + j) & load<Bits>(chain.revolute_bits.data() + j);
  const V angle = bits_as<V>(bits) + load<V>(chain.theta.data() + j);
  V sine;
  V cosine;
  sine_cosine<Scalar>(angle, sine, cosine);
  store(terms.sine.data() + j, sine);
  store(terms.cosine.data() + j, cosine);
  return (bits_as<V>(bits_as<Bits>(angle) & kNoSign) <= SineCosineConstants<Scalar>::kLargestAngle);
}

// Sines, cosines and heights at readings q (room for kMaxJoints numbers). False if one is not
// finite.
template <typename Scalar>
[[nodiscard]] [[gnu::always_inline]] inline bool joint_terms(const ChainT<Scalar>& chain,
                                                             const Scalar* q,
                                                             JointTerms<Scalar>& terms) {
  constexpr std::size_t kCount = Lanes<Scalar>::kCount;
  terms.z = chain.z.data();
  if (chain.has_prismatic) [[unlikely]] {
    if (!prismatic_heights(chain, q, terms)) return false;
    terms.z = terms.height.data();
  }
  if constexpr (kCount == 1) {
    for (std::size_t j = 0; j < chain.joint_count; ++j) {
      Scalar angle = chain.theta[j];
      if (chain.revolute[j]) [[likely]]
        angle += q[j];
      if (!(std::abs(angle) <= SineCosineConstants<Scalar>::kLargestAngle)) [[unlikely]] {
        return large_angles(chain, q, terms);
      }
      sine_cosine_of_one(angle, terms.sine[j], terms.cosine[j]);
    }
    return true;
  }
  PackMask<Scalar> in_reach = ~PackMask<Scalar>{};
  if constexpr (2 * kCount == kMaxJoints) {
    // Both packs at once: their work overlaps, and the constants are loaded once.
    in_reach = pack_terms(chain, q, terms, 0) & pack_terms(chain, q, terms, kCount);
  } else {
    for (std::size_t j = 0; j < chain.joint_count; j += kCount)
      in_reach &= pack_terms(chain, q, terms, j);
  }
  if (!all(in_reach)) [[unlikely]]
    return large_angles(chain, q, terms);
  return true;
}

}  // namespace ARMSIG_LANES
}  // namespace armsig::kinematics
