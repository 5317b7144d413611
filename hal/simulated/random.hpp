// SPDX-License-Identifier: MIT
// Random numbers that are the same on every machine and compiler, bit for bit.
//
// The standard library's distributions are not: each library has its own.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/pose.hpp"

namespace armsig::simulated {

// xoshiro256** (Blackman and Vigna, "Scrambled linear pseudorandom number generators", ACM TOMS 47,
// 2021), its state filled by splitmix64 from the seed, as its authors advise.
class Random {
 public:
  // Different streams of one seed are independent: one seed for a whole experiment, one stream for
  // each source of randomness in it.
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  [[nodiscard]] std::uint64_t bits();
  // Uniform in [0, 1), a multiple of 2^-53.
  [[nodiscard]] double uniform();
  [[nodiscard]] double uniform(double lower, double upper);
  [[nodiscard]] bool chance(double probability) { return uniform() < probability; }
  // Standard normal, by Marsaglia's polar method.
  [[nodiscard]] double normal();
  // Three independent standard normals; a unit vector of uniform direction.
  [[nodiscard]] Vector3 normal_vector();
  [[nodiscard]] Vector3 direction();

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0;
  bool has_spare_normal_ = false;
};

// Natural logarithm of a positive normal number within 2e-16 of its magnitude or of 1, from sums,
// products and quotients alone: libraries' logarithms differ in the last digit.
[[nodiscard]] double portable_log(double x);

}  // namespace armsig::simulated
