// SPDX-License-Identifier: MIT
#include "core/features/motion_sums.hpp"

#include <algorithm>
#include <array>

#include "core/base/lanes.hpp"
#include "core/base/sine_cosine.hpp"

namespace armsig::features {
namespace {

using V = Pack<double>;
constexpr std::size_t kLanes = Lanes<double>::kCount;

// Least sine of the angle that three points show the first one under, as chords: below it the
// motion through them is not worth the name.
constexpr double kLeastSine = 1e-3;
// Least square of a pivot over that of its column: of the sums' 16 digits, 10 are left.
constexpr double kLeastPivot = 1e-6;

// A motion through three of the points, from which the distances of all are measured.
struct Reference {
  Vector3 at_rest_S;  // at the origin reading
  Vector3 along_sine;
  Vector3 along_versine;
};

// motion_regressors() of several readings at once: sin t and 1 - cos t.
[[gnu::always_inline]] inline void regressors_of(V moved, V& sine, V& versine) {
  V s;
  V c;
  sine_cosine<double>(0.5 * moved, s, c);
  const V twice = s + s;
  sine = twice * c;
  versine = twice * s;
}

// A number of as many points as there are lanes; `number(i)` that of the i-th.
template <typename Number>
[[gnu::always_inline]] inline V gather(Number number) {
  if constexpr (kLanes == 1) {
    return number(0);
  } else if constexpr (kLanes == 2) {
    return V{number(0), number(1)};
  } else {
    return V{number(0), number(1), number(2), number(3)};
  }
}

// False where the three do not span the motion.
bool through_three(std::span<const SweepPoint> points, double origin_reading,
                   Reference& reference) {
  const SweepPoint& a = points.front();
  const SweepPoint& b = points[points.size() / 2];
  const SweepPoint& c = points.back();
  const std::array<const SweepPoint*, 4> three = {&a, &b, &c, &c};
  std::array<double, 4> sine;
  std::array<double, 4> versine;
#pragma GCC unroll 3
  for (std::size_t k = 0; k < 3; k += kLanes) {
    V s;
    V v;
    regressors_of(gather([&](std::size_t i) { return three[k + i]->reading; }) - origin_reading, s,
                  v);
    store(&sine[k], s);
    store(&versine[k], v);
  }
  const double sine_ab = sine[1] - sine[0];
  const double sine_ac = sine[2] - sine[0];
  const double versine_ab = versine[1] - versine[0];
  const double versine_ac = versine[2] - versine[0];
  const double area = sine_ab * versine_ac - versine_ab * sine_ac;
  const double sides =
      (sine_ab * sine_ab + versine_ab * versine_ab) * (sine_ac * sine_ac + versine_ac * versine_ac);
  if (!(area * area > kLeastSine * kLeastSine * sides)) return false;
  const double inverse = 1 / area;
  for (int i = 0; i < 3; ++i) {
    const double p_ab = inverse * (b.p_S[i] - a.p_S[i]);
    const double p_ac = inverse * (c.p_S[i] - a.p_S[i]);
    const double s = versine_ac * p_ab - versine_ab * p_ac;
    const double v = sine_ab * p_ac - sine_ac * p_ab;
    reference.along_sine[i] = s;
    reference.along_versine[i] = v;
    reference.at_rest_S[i] = (a.p_S[i] - sine[0] * s) - versine[0] * v;
  }
  return true;
}

// Whether all the points have that very covariance: nine numbers as packs, the last of which
// overlaps the one before.
[[gnu::noinline]] bool all_have(std::span<const SweepPoint> points, const Matrix3& covariance_m2) {
  using Bits = PackMask<double>;
  constexpr std::size_t kPacks = (9 + kLanes - 1) / kLanes;
  constexpr auto kPackOf = [](const Matrix3& of, std::size_t i) {
    return bits_as<Bits>(load<V>(of.data() + std::min(i * kLanes, 9 - kLanes)));
  };
  std::array<Bits, kPacks> wanted;
  for (std::size_t i = 0; i < kPacks; ++i) wanted[i] = kPackOf(covariance_m2, i);
  Bits difference{};
#pragma GCC unroll 4
  for (const SweepPoint& point : points) {
#pragma GCC unroll 9
    for (std::size_t i = 0; i < kPacks; ++i)
      difference |= wanted[i] ^ kPackOf(point.covariance_m2, i);
  }
  return all(difference == 0);
}

// The upper triangle of the sums of products of the columns 1, sin t, 1 - cos t and the three
// distances from the reference.
constexpr std::size_t kColumns = 6;
constexpr std::size_t kRegressors = 3;
static_assert(std::tuple_size_v<MotionRls::Kept> == kRegressors);
using Products = std::array<std::array<double, kColumns>, kColumns>;

// Points are taken in blocks, the readings of a block before its distances: so the processor has
// the sines of several packs in flight at once, and registers for the sums.
constexpr std::size_t kBlock = 64;
struct Readings {
  double lowest;
  double highest;
  alignas(32) std::array<double, kBlock> sine;
  alignas(32) std::array<double, kBlock> versine;
};

[[gnu::noinline]] void take_readings(std::span<const SweepPoint> points, double origin_reading,
                                     Readings& readings, Products& products) {
  V lowest = V{} + points.front().reading;
  V highest = lowest;
  V s_sum{};
  V v_sum{};
  V ss{};
  V sv{};
  V vv{};
  for (std::size_t k = 0; k < points.size(); k += kLanes) {
    const V reading = gather([&](std::size_t i) { return points[k + i].reading; });
    lowest = reading < lowest ? reading : lowest;
    highest = reading > highest ? reading : highest;
    V s;
    V v;
    regressors_of(reading - origin_reading, s, v);
    store(&readings.sine[k], s);
    store(&readings.versine[k], v);
    s_sum += s;
    v_sum += v;
    ss += s * s;
    sv += s * v;
    vv += v * v;
  }
  readings.lowest = least_of_lanes<double>(lowest);
  readings.highest = -least_of_lanes<double>(-highest);
  products[0][0] += static_cast<double>(points.size());
  products[0][1] += sum_of_lanes<double>(s_sum);
  products[0][2] += sum_of_lanes<double>(v_sum);
  products[1][1] += sum_of_lanes<double>(ss);
  products[1][2] += sum_of_lanes<double>(sv);
  products[2][2] += sum_of_lanes<double>(vv);
}

[[gnu::noinline]] void take_distances(std::span<const SweepPoint> points, const Readings& readings,
                                      const Reference& reference, Products& products) {
  std::array<V, 3> sums{};
  std::array<V, 3> s_moments{};
  std::array<V, 3> v_moments{};
  std::array<V, 6> squares{};
  for (std::size_t k = 0; k < points.size(); k += kLanes) {
    const V s = load<V>(&readings.sine[k]);
    const V v = load<V>(&readings.versine[k]);
    std::array<V, 3> d;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const V p = gather([&](std::size_t j) { return points[k + j].p_S[i]; });
      d[i] = ((p - reference.at_rest_S[i]) - s * reference.along_sine[i]) -
             v * reference.along_versine[i];
    }
    std::size_t place = 0;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      sums[i] += d[i];
      s_moments[i] += s * d[i];
      v_moments[i] += v * d[i];
#pragma GCC unroll 3
      for (int j = i; j < 3; ++j) squares[place++] += d[i] * d[j];
    }
  }
  std::size_t place = 0;
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    products[0][3 + i] += sum_of_lanes<double>(sums[i]);
    products[1][3 + i] += sum_of_lanes<double>(s_moments[i]);
    products[2][3 + i] += sum_of_lanes<double>(v_moments[i]);
#pragma GCC unroll 3
    for (int j = i; j < 3; ++j) products[3 + i][3 + j] += sum_of_lanes<double>(squares[place++]);
  }
}

// Eliminates the regressors: leaves, in their rows, the pivot and the rest divided by it, in the
// others the products of the residuals. False where a pivot is too small beside its column.
bool eliminate(Products& products) {
#pragma GCC unroll 3
  for (std::size_t i = 0; i < kRegressors; ++i) {
    const double pivot = products[i][i];
    double column = pivot;
#pragma GCC unroll 3
    for (std::size_t j = 0; j < i; ++j) column += products[j][j] * products[j][i] * products[j][i];
    if (!(pivot > kLeastPivot * column)) return false;
    const double inverse = 1 / pivot;
    std::array<double, kColumns>& row = products[i];
#pragma GCC unroll 6
    for (std::size_t j = i + 1; j < kColumns; ++j) {
      const double factor = row[j] * inverse;
#pragma GCC unroll 6
      for (std::size_t k = j; k < kColumns; ++k) products[j][k] -= factor * row[k];
      row[j] = factor;
    }
  }
  return true;
}

}  // namespace

bool motion_sums(std::span<const SweepPoint> points, double origin_reading, const Vector3& origin_S,
                 const Matrix3& covariance_m2, MotionSums& result) {
  Reference reference;
  if (!through_three(points, origin_reading, reference)) return false;
  constexpr double kMost = SineCosineConstants<double>::kLargestAngle;
  Products products{};
  Readings readings;
  result.lowest_reading = result.highest_reading = points.front().reading;
  for (std::size_t first = 0; first < points.size(); first += kBlock) {
    const auto block = points.subspan(first, std::min(kBlock, points.size() - first));
    if (!all_have(block, covariance_m2)) return false;
    take_readings(block, origin_reading, readings, products);
    result.lowest_reading = std::min(result.lowest_reading, readings.lowest);
    result.highest_reading = std::max(result.highest_reading, readings.highest);
    take_distances(block, readings, reference, products);
  }
  if (!(origin_reading - result.lowest_reading <= kMost &&
        result.highest_reading - origin_reading <= kMost))
    return false;
  if (!eliminate(products)) return false;

  // Back from the reference to its origin.
  const double weight = 3 / covariance_m2.trace();
  const std::array<Vector3, kRegressors> coefficients = {
      reference.at_rest_S - origin_S, reference.along_sine, reference.along_versine};
#pragma GCC unroll 3
  for (std::size_t i = 0; i < kRegressors; ++i) {
    MotionRls::Row& row = result.rows[i];
    row[i] = weight * products[i][i];
#pragma GCC unroll 3
    for (std::size_t j = i + 1; j < kRegressors; ++j) row[j] = products[i][j];
#pragma GCC unroll 3
    for (int j = 0; j < 3; ++j) {
      double coefficient = products[i][kRegressors + j] + coefficients[i][j];
#pragma GCC unroll 3
      for (std::size_t k = i + 1; k < kRegressors; ++k)
        coefficient += products[i][k] * coefficients[k][j];
      row[kRegressors + j] = coefficient;
    }
  }
  std::size_t place = 0;
#pragma GCC unroll 3
  for (std::size_t i = kRegressors; i < kColumns; ++i) {
    products[i][i] = std::max(products[i][i], 0.0);  // below zero by rounding only
#pragma GCC unroll 3
    for (std::size_t j = i; j < kColumns; ++j)
      result.residual_products[place++] = weight * products[i][j];
  }
  return true;
}

}  // namespace armsig::features
