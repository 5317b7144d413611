// SPDX-License-Identifier: MIT
#include "hal/simulated/random.hpp"

#include <bit>
#include <cmath>
#include <numbers>

#include "core/base/check.hpp"

namespace armsig::simulated {

namespace {

// Steele, Lea and Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
std::uint64_t splitmix64(std::uint64_t& state) {
  state += 0x9e3779b97f4a7c15;
  std::uint64_t z = state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
  z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
  return z ^ (z >> 31);
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) {
  // The stream is scrambled before it meets the seed, so that seed 1 of stream 2 isn't seed 2 of
  // stream 1.
  std::uint64_t scrambled = stream;
  std::uint64_t state = stream == 0 ? seed : seed ^ splitmix64(scrambled);
  for (std::uint64_t& word : state_) word = splitmix64(state);
}

std::uint64_t Random::bits() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

double Random::uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

double Random::normal() {
  if (has_spare_normal_) {
    has_spare_normal_ = false;
    return spare_normal_;
  }
  double x = 0;
  double y = 0;
  double s = 0;
  do {
    x = uniform(-1, 1);
    y = uniform(-1, 1);
    s = x * x + y * y;
  } while (s >= 1 || s == 0);
  const double scale = std::sqrt(-2 * portable_log(s) / s);
  spare_normal_ = y * scale;
  has_spare_normal_ = true;
  return x * scale;
}

Vector3 Random::normal_vector() {
  // One statement each: the order of evaluation within one would be the compiler's choice.
  const double x = normal();
  const double y = normal();
  const double z = normal();
  return {x, y, z};
}

Vector3 Random::direction() {
  Vector3 v = normal_vector();
  while (v.isZero(1e-6)) v = normal_vector();
  // Not norm(): its order of summation depends on the vector unit.
  return v / std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z());
}

double portable_log(double x) {
  ARMSIG_CHECK(std::isnormal(x));
  ARMSIG_CHECK(x > 0);
  constexpr double kRootHalf = std::numbers::sqrt2 / 2;
  // x = m 2^e with m in [sqrt(1/2), sqrt(2)), and log m = 2 artanh z, z = (m - 1) / (m + 1), |z| <
  // 0.172: the terms beyond z^21 are below 1e-17.
  int e = 0;
  double m = std::frexp(x, &e);
  if (m < kRootHalf) {
    m *= 2;
    --e;
  }
  const double z = (m - 1) / (m + 1);
  double sum = 0;
  for (int k = 21; k >= 1; k -= 2) sum = sum * (z * z) + 1.0 / k;
  return 2 * z * sum + e * std::numbers::ln2;
}

}  // namespace armsig::simulated
