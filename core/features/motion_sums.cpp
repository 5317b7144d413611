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

// The coefficients of the motion through three of the points.
std::optional<MotionRls::Coefficients> through_three(std::span<const SweepPoint> points,
                                                     double origin_reading,
                                                     const Vector3& origin_S) {
  const SweepPoint& a = points.front();
  const SweepPoint& b = points[points.size() / 2];
  const SweepPoint& c = points.back();
  const auto regressors = [&](const SweepPoint& point) {
    return motion_regressors(JointType::kRevolute, point.reading - origin_reading);
  };
  const Vector3 x_a = regressors(a);
  const Vector3 to_b = regressors(b) - x_a;
  const Vector3 to_c = regressors(c) - x_a;
  const double area = to_b[1] * to_c[2] - to_b[2] * to_c[1];
  const double sides = to_b.squaredNorm() * to_c.squaredNorm();
  if (!(area * area > kLeastSine * kLeastSine * sides)) return std::nullopt;
  const double inverse = 1 / area;
  const Vector3 p_ab = inverse * (b.p_S - a.p_S);
  const Vector3 p_ac = inverse * (c.p_S - a.p_S);
  MotionRls::Coefficients phi;
  phi.row(1) = to_c[2] * p_ab - to_b[2] * p_ac;
  phi.row(2) = to_b[1] * p_ac - to_c[1] * p_ab;
  phi.row(0) = (a.p_S - origin_S).transpose() - x_a[1] * phi.row(1) - x_a[2] * phi.row(2);
  return phi;
}

// One coordinate of as many points as there are lanes.
template <typename Coordinate>
[[gnu::always_inline]] inline V gather(const SweepPoint* point, Coordinate coordinate) {
  if constexpr (kLanes == 1) {
    return coordinate(point[0]);
  } else if constexpr (kLanes == 2) {
    return V{coordinate(point[0]), coordinate(point[1])};
  } else {
    return V{coordinate(point[0]), coordinate(point[1]), coordinate(point[2]),
             coordinate(point[3])};
  }
}

// Nine numbers as packs, the last of which overlaps the one before.
class NineBits {
 public:
  explicit NineBits(const Matrix3& of) {
    for (std::size_t i = 0; i < kPacks; ++i) bits_[i] = load_bits(of.data() + at(i));
  }
  // Adds to `difference` where `other` differs in a bit.
  [[gnu::always_inline]] void compare(const Matrix3& other, PackMask<double>& difference) const {
#pragma GCC unroll 9
    for (std::size_t i = 0; i < kPacks; ++i)
      difference |= bits_[i] ^ load_bits(other.data() + at(i));
  }

 private:
  static constexpr std::size_t kPacks = (9 + kLanes - 1) / kLanes;
  static constexpr std::size_t at(std::size_t i) { return std::min(i * kLanes, 9 - kLanes); }
  static PackMask<double> load_bits(const double* from) {
    return bits_as<PackMask<double>>(load<V>(from));
  }
  std::array<PackMask<double>, kPacks> bits_;
};

// The upper triangle of the sums of products of the columns 1, sin t, 1 - cos t and the three
// distances from the reference.
constexpr std::size_t kColumns = 6;
constexpr std::size_t kRegressors = 3;
using Products = std::array<std::array<double, kColumns>, kColumns>;
static_assert(std::tuple_size_v<MotionRls::Kept> == kRegressors);

// Eliminates the regressors: leaves, in their rows, the pivot and the rest divided by it, in the
// others the products of the residuals. False where a pivot is too small beside its column.
bool eliminate(Products& products) {
  for (std::size_t i = 0; i < kRegressors; ++i) {
    const double pivot = products[i][i];
    double column = pivot;
    for (std::size_t j = 0; j < i; ++j) column += products[j][j] * products[j][i] * products[j][i];
    if (!(pivot > kLeastPivot * column)) return false;
    const double inverse = 1 / pivot;
    std::array<double, kColumns>& row = products[i];
#pragma GCC unroll 6
    for (std::size_t j = i + 1; j < kColumns; ++j) {
      const double factor = row[j] * inverse;
      for (std::size_t k = j; k < kColumns; ++k) products[j][k] -= factor * row[k];
      row[j] = factor;
    }
  }
  return true;
}

struct Sums {
  Products products;
  double lowest_reading;
  double highest_reading;
  bool same_covariance;
};

Sums sum_up(std::span<const SweepPoint> points, double origin_reading, const Vector3& origin_S,
            const Matrix3& covariance_m2, const MotionRls::Coefficients& reference) {
  const NineBits covariance(covariance_m2);
  const Vector3 at_rest = origin_S + reference.row(0).transpose();
  std::array<V, kColumns - 1> sums{};
  std::array<V, kColumns*(kColumns - 1) / 2> squares{};
  PackMask<double> difference{};
  V lowest = V{} + points.front().reading;
  V highest = lowest;
  for (std::size_t k = 0; k < points.size(); k += kLanes) {
    const SweepPoint* point = &points[k];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < kLanes; ++i) covariance.compare(point[i].covariance_m2, difference);
    const V reading = gather(point, [](const SweepPoint& p) { return p.reading; });
    lowest = reading < lowest ? reading : lowest;
    highest = reading > highest ? reading : highest;
    // motion_regressors() and the distance from the reference.
    V s;
    V c;
    sine_cosine<double>(0.5 * (reading - origin_reading), s, c);
    const V twice = 2 * s;
    std::array<V, kColumns - 1> columns;
    columns[0] = twice * c;
    columns[1] = twice * s;
#pragma GCC unroll 3
    for (int i = 0; i < 3; ++i) {
      const V p = gather(point, [i](const SweepPoint& at) { return at.p_S[i]; });
      columns[2 + i] =
          ((p - at_rest[i]) - columns[0] * reference(1, i)) - columns[1] * reference(2, i);
    }
    std::size_t place = 0;
#pragma GCC unroll 5
    for (std::size_t i = 0; i + 1 < kColumns; ++i) {
      sums[i] += columns[i];
#pragma GCC unroll 5
      for (std::size_t j = i; j + 1 < kColumns; ++j) squares[place++] += columns[i] * columns[j];
    }
  }
  Sums result;
  Products& products = result.products;
  products[0][0] = static_cast<double>(points.size());
  std::size_t place = 0;
#pragma GCC unroll 5
  for (std::size_t i = 1; i < kColumns; ++i) {
    products[0][i] = sum_of_lanes<double>(sums[i - 1]);
#pragma GCC unroll 5
    for (std::size_t j = i; j < kColumns; ++j)
      products[i][j] = sum_of_lanes<double>(squares[place++]);
  }
  std::array<double, kLanes> lanes;
  store(lanes.data(), lowest);
  result.lowest_reading = std::ranges::min(lanes);
  store(lanes.data(), highest);
  result.highest_reading = std::ranges::max(lanes);
  result.same_covariance = all(difference == 0);
  return result;
}

}  // namespace

std::optional<MotionSums> motion_sums(std::span<const SweepPoint> points, double origin_reading,
                                      const Vector3& origin_S, const Matrix3& covariance_m2) {
  const auto reference = through_three(points, origin_reading, origin_S);
  if (!reference) return std::nullopt;
  Sums sums = sum_up(points, origin_reading, origin_S, covariance_m2, *reference);
  constexpr double kMost = SineCosineConstants<double>::kLargestAngle;
  if (!sums.same_covariance || origin_reading - sums.lowest_reading > kMost ||
      sums.highest_reading - origin_reading > kMost || !eliminate(sums.products))
    return std::nullopt;

  // Back from the reference to its origin.
  const double weight = 3 / covariance_m2.trace();
  MotionRls::Kept kept;
  MotionRls::Products residuals;
  for (std::size_t i = 0; i < kRegressors; ++i) {
    kept[i] = sums.products[i];
    for (std::size_t j = kRegressors; j < kColumns; ++j) {
      const auto coordinate = static_cast<Eigen::Index>(j - kRegressors);
      kept[i][j] += (*reference)(static_cast<Eigen::Index>(i), coordinate);
      for (std::size_t k = i + 1; k < kRegressors; ++k)
        kept[i][j] += kept[i][k] * (*reference)(static_cast<Eigen::Index>(k), coordinate);
    }
    kept[i][i] *= weight;
  }
  for (int i = 0; i < 3; ++i) {
    const auto& row = sums.products[kRegressors + static_cast<std::size_t>(i)];
    for (int j = i; j < 3; ++j)
      residuals(i, j) = weight * row[kRegressors + static_cast<std::size_t>(j)];
    residuals(i, i) = std::max(residuals(i, i), 0.0);  // below zero by rounding only
  }
  return MotionSums{MotionRls(kept, residuals), sums.lowest_reading, sums.highest_reading};
}

}  // namespace armsig::features
