// SPDX-License-Identifier: MIT
// Sine and cosine, of several angles at once or of one.
//
// Argument: k = round(x / pi) and r = x - k pi in three steps (Cody and Waite), |r| <= pi/2, so
// that both sine and cosine only change sign with k. The first two parts of pi have so few bits
// that k times them is exact for |x| <= kLargestAngle, with or without fused multiply-add. Then, u
// = r^2,
//   sin r = r + r u P(u),   cos r = 1 - u/2 + u^2 Q(u),
// P and Q interpolating at the Chebyshev nodes of [0, (pi/2)^2].
//
// Bound of the absolute error in double precision: P and Q are off by at most 3.6e-17 and 6.3e-17
// in the result; the roundings of r give at most 2^-52, the sum, its products and u at most 2^-52.
// In total 5.1e-16; in single precision the same count gives 2^-22 (2.4e-7). The unit tests
// compare dense and random angles with extended precision.
#pragma once

#include <array>
#include <cmath>

#include "core/base/lanes.hpp"

namespace armsig {
inline namespace ARMSIG_LANES {

template <typename Scalar>
struct SineCosineConstants;

template <>
struct SineCosineConstants<double> {
  using Integer = std::int64_t;
  // 160,000 turns; beyond, the library's functions take over.
  static constexpr double kLargestAngle = 1e6;
  static constexpr double kRound = 0x1.8p52;  // adding it rounds to an integer in the low bits
  // Pi in three parts whose products with the number of turns are exact, hence not
  // std::numbers::pi. NOLINTBEGIN(modernize-use-std-numbers)
  static constexpr double kOneOverPi = 0x1.45f306dc9c883p-2;
  static constexpr double kPi1 = 0x1.921fb544p+1;  // 33 bits
  static constexpr double kPi2 = 0x1.0b4611a6p-33;
  static constexpr double kPi3 = 0x1.3198a2e037073p-68;
  // NOLINTEND(modernize-use-std-numbers)
  static constexpr std::array<double, 8> kSine = {
      -0x1.5555555555555p-3,  0x1.1111111111107p-7,  -0x1.a01a01a018aadp-13, 0x1.71de3a5456710p-19,
      -0x1.ae6455a1d6d16p-26, 0x1.6124015b4d09ap-33, -0x1.ae5138bb6e53dp-41, 0x1.89a485b963ce2p-49};
  static constexpr std::array<double, 7> kCosine = {
      0x1.5555555555554p-5,  -0x1.6c16c16c164aap-10, 0x1.a01a019f59576p-16, -0x1.27e4fb02554edp-22,
      0x1.1eed4b0ec2936p-29, -0x1.936ed1986a3e6p-37, 0x1.a283840f19160p-45};
};

template <>
struct SineCosineConstants<float> {
  using Integer = std::int32_t;
  static constexpr float kLargestAngle = 2e4F;  // 3,000 turns
  static constexpr float kRound = 0x1.8p23F;
  // NOLINTBEGIN(modernize-use-std-numbers)
  static constexpr float kOneOverPi = 0x1.45f306p-2F;
  static constexpr float kPi1 = 0x1.92p+1F;  // 11 bits
  static constexpr float kPi2 = 0x1.fb4p-11F;
  static constexpr float kPi3 = 0x1.4442d2p-23F;
  // NOLINTEND(modernize-use-std-numbers)
  static constexpr std::array<float, 4> kSine = {-0x1.555554p-3F, 0x1.11104ep-7F, -0x1.9fb686p-13F,
                                                 0x1.61a18ap-19F};
  static constexpr std::array<float, 4> kCosine = {0x1.555556p-5F, -0x1.6c163ep-10F,
                                                   0x1.9fd76ap-16F, -0x1.1d0944p-22F};
};

// c0 + c1 u + ..., in pairs so that the processor can work on several terms at once; u2 = u^2.
template <std::size_t kFirst = 0, typename V, std::size_t kTerms>
[[nodiscard]] inline V polynomial(const std::array<double, kTerms>& c, V u, V u2) {
  if constexpr (kFirst + 1 == kTerms) {
    return V{} + c[kFirst];
  } else if constexpr (kFirst + 2 == kTerms) {
    return c[kFirst] + c[kFirst + 1] * u;
  } else {
    return (c[kFirst] + c[kFirst + 1] * u) + u2 * polynomial<kFirst + 2>(c, u, u2);
  }
}

// The same without pairs, for processors that work on one term at a time: fewer registers.
template <std::size_t kFirst = 0, typename Scalar, std::size_t kTerms>
[[nodiscard]] inline Scalar nested(const std::array<Scalar, kTerms>& c, Scalar u) {
  if constexpr (kFirst + 1 == kTerms) {
    return c[kFirst];
  } else {
    return c[kFirst] + u * nested<kFirst + 1>(c, u);
  }
}

// For every lane |angle| <= kLargestAngle (else the result is meaningless).
[[gnu::always_inline]] inline void sine_cosine(Pack<double> angle, Pack<double>& sine,
                                               Pack<double>& cosine) {
  using Constants = SineCosineConstants<double>;
  using V = Pack<double>;
  using Bits = PackMask<double>;

  const V shifted = angle * Constants::kOneOverPi + Constants::kRound;
  const V k = shifted - Constants::kRound;
  const V r = ((angle - k * Constants::kPi1) - k * Constants::kPi2) - k * Constants::kPi3;
  const V u = r * r;
  const V u2 = u * u;
  const V s = r + (r * u) * polynomial(Constants::kSine, u, u2);
  const V c = (1 - 0.5 * u) + u2 * polynomial(Constants::kCosine, u, u2);
  const Bits sign = bits_as<Bits>(shifted) << 63;  // odd half turns negate both
  sine = bits_as<V>(bits_as<Bits>(s) ^ sign);
  cosine = bits_as<V>(bits_as<Bits>(c) ^ sign);
}

// One angle on a processor that works on one term at a time.
template <typename Scalar>
[[gnu::always_inline]] inline void sine_cosine_of_one(Scalar angle, Scalar& sine, Scalar& cosine) {
  using Constants = SineCosineConstants<Scalar>;
  const Scalar shifted = angle * Constants::kOneOverPi + Constants::kRound;
  const Scalar k = shifted - Constants::kRound;
  const Scalar r = ((angle - k * Constants::kPi1) - k * Constants::kPi2) - k * Constants::kPi3;
  const Scalar u = r * r;
  const Scalar s = r + r * (u * nested(Constants::kSine, u));
  const Scalar c = Scalar(1) + u * (Scalar(-0.5) + u * nested(Constants::kCosine, u));
  const bool odd = (bits_as<typename Constants::Integer>(shifted) & 1) != 0;
  sine = odd ? -s : s;
  cosine = odd ? -c : c;
}

template <typename Scalar>
struct SineCosineT {
  Scalar sine = 0;
  Scalar cosine = 1;
};
using SineCosine = SineCosineT<double>;

// Of any finite angle; beyond the reach of the polynomials by the library's functions.
template <typename Scalar>
[[nodiscard]] SineCosineT<Scalar> sine_and_cosine(Scalar angle) {
  SineCosineT<Scalar> result;
  if (std::abs(angle) <= SineCosineConstants<Scalar>::kLargestAngle) [[likely]] {
    sine_cosine_of_one(angle, result.sine, result.cosine);
  } else {
    result = {std::sin(angle), std::cos(angle)};
  }
  return result;
}

}  // namespace ARMSIG_LANES
}  // namespace armsig
