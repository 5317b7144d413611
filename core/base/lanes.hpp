// SPDX-License-Identifier: MIT
// Small vectors of numbers that the processor handles at once (GCC's vector extension: the compiler
// maps them to SSE2, AVX2, NEON or scalars, whatever the build is for).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#ifdef __SSE2__
#include <immintrin.h>
#endif

// What depends on the flags of a build bears their name: a program and the library that it links
// may be built with different ones, and the linker must not take the one's for the other's.
#if defined(__arm__) && !defined(__ARM_NEON)
#define ARMSIG_LANES one_lane
#elif defined(__AVX2__)
#define ARMSIG_LANES four_lanes
#else
#define ARMSIG_LANES two_lanes
#endif

namespace armsig {
inline namespace ARMSIG_LANES {

// Pack: the numbers of one register. Mask: integers of the same width, all ones or all zeros.
template <typename Scalar>
struct Lanes;

template <>
struct Lanes<double> {
  using Integer = std::int64_t;
#if defined(__arm__) && !defined(__ARM_NEON)
  // One number at a time, as itself: a vector that the compiler has to take apart would pass
  // through memory.
  static constexpr std::size_t kCount = 1;
  using Pack = double;
  using Mask = Integer;
#else
#ifdef __AVX2__
  static constexpr std::size_t kCount = 4;
#else
  static constexpr std::size_t kCount = 2;
#endif
  using Pack [[gnu::vector_size(kCount * sizeof(double))]] = double;
  using Mask [[gnu::vector_size(kCount * sizeof(double))]] = Integer;
#endif
};

template <typename Scalar>
using Pack = typename Lanes<Scalar>::Pack;
template <typename Scalar>
using PackMask = typename Lanes<Scalar>::Mask;

// The bits of `from` as a `To`; also for packs.
template <typename To, typename From>
[[nodiscard]] inline To bits_as(const From& from) {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof(to));
  return to;
}

// A pack of one is read and written as itself: through std::memcpy it would take the way of two
// integers.
template <typename V, typename T>
[[nodiscard]] inline V load(const T* from) {
  if constexpr (std::is_same_v<V, T>) {
    return *from;
  } else {
    V pack;
    std::memcpy(&pack, from, sizeof(pack));
    return pack;
  }
}

template <typename V, typename T>
inline void store(T* to, const V& pack) {
  if constexpr (std::is_same_v<V, T>) {
    *to = pack;
  } else {
    std::memcpy(to, &pack, sizeof(pack));
  }
}

template <typename Scalar>
[[nodiscard]] inline Scalar sum_of_lanes(const Pack<Scalar>& pack) {
  if constexpr (Lanes<Scalar>::kCount == 1) {
    return pack;
  } else if constexpr (Lanes<Scalar>::kCount == 2) {
    return pack[0] + pack[1];
  } else {
    const auto halves =
        __builtin_shufflevector(pack, pack, 0, 1) + __builtin_shufflevector(pack, pack, 2, 3);
    return halves[0] + halves[1];
  }
}

// Whether every lane of `mask` is set.
template <typename Mask>
[[nodiscard]] inline bool all(const Mask& mask) {
#ifdef __SSE2__
  if constexpr (sizeof(Mask) == sizeof(__m128i)) {
    return _mm_movemask_epi8(bits_as<__m128i>(mask)) == 0xffff;
  }
#endif
#ifdef __AVX2__
  if constexpr (sizeof(Mask) == sizeof(__m256i)) {
    return _mm256_movemask_epi8(bits_as<__m256i>(mask)) == -1;
  }
#endif
  if constexpr (std::is_integral_v<Mask>) {
    return mask != 0;
  } else {
    bool result = true;
    for (std::size_t i = 0; i < sizeof(Mask) / sizeof(mask[0]); ++i) {
      result = result && mask[i] != 0;
    }
    return result;
  }
}

}  // namespace ARMSIG_LANES
}  // namespace armsig
